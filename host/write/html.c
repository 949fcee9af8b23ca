/*
 * html.c - a page that shows the surface in a browser: one file, which loads nothing else
 *
 * viewer.html as it is, and behind it what it shows, as scripts of types that no browser runs:
 *
 *     mesh                            JSON: counts, whether there are normals, what is known of the coordinates; of a
 *                                     label map `pairs`: for triangles that follow each other their two labels, and
 *                                     how many they are. So the page draws each pair in the colours of its labels
 *     positions, normals, triangles   base64 of their records, each 12 bytes and so 16 characters: 3 float32 or uint32
 *
 * A text in a browser may have 2^29 characters, hence the limit.
 */
#include "file_text.h"
#include "label_order.h"

#include <errno.h>

enum { RECORD_BYTES = 12, RECORD_CHARACTERS = 16, TEXT_MOST = 1 << 28 };

extern const char viewer_text[];

int html_fits(const shown_mesh *s) {
    const uint64_t vertices = file_vertex_count(s), triangles = s->mesh->triangle_count;
    return (vertices > triangles ? vertices : triangles) <= TEXT_MOST / RECORD_CHARACTERS;
}

static unsigned char *put_base64(unsigned char *to, const unsigned char *from, size_t bytes) {
    static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    for (size_t n = 0; n < bytes; n += 3) {
        const unsigned three = (unsigned)from[n] << 16 | (unsigned)from[n + 1] << 8 | from[n + 2];
        for (int shift = 18; shift >= 0; shift -= 6) *to++ = (unsigned char)digits[three >> shift & 63];
    }
    return to;
}

/* Of a record_array. */
static unsigned char *encode_base64(const void *source, uint64_t first, uint64_t end, unsigned char *to) {
    const record_array *records = source;
    unsigned char record[RECORD_BYTES];
    for (uint64_t n = first; n < end; n++) {
        if (records->encode)
            records->encode(records->source, n, n + 1, record);
        else
            memcpy(record, (const unsigned char *)records->source + RECORD_BYTES * n, RECORD_BYTES);
        to = put_base64(to, record, RECORD_BYTES);
    }
    return to;
}

static void write_array(output *o, const char *id, record_array records) {
    file_text head = {0};
    text_add(&head, "<script type=\"text/plain\" id=\"%s\">", id);
    if (head.has_failed) o->error = ENOMEM;
    output_bytes(o, head.bytes, head.length);
    output_records(o, records.span.count, RECORD_CHARACTERS, encode_base64, &records);
    output_bytes(o, "</script>\n", 10);
    text_release(&head);
}

static void list_pairs(file_text *t, const label_order *order) {
    const uint64_t count = order->triangles ? order->shown->mesh->triangle_count : 0;
    text_add(t, ", \"pairs\": [");
    for (uint64_t n = 0, end; n < count; n = end) {
        const uint32_t *labels = label_order_at(order, n);
        end = label_order_end(order, n, 1);
        text_add(t, "%s[%u, %u, %llu]", n ? ", " : "", labels[0], labels[1], (unsigned long long)(end - n));
    }
    text_add(t, "]");
}

static void write_about(output *o, const shown_mesh *s, const label_order *order) {
    file_text t = {0};
    text_add(&t,
             "<script type=\"application/json\" id=\"mesh\">{\"vertices\": %llu, \"triangles\": %llu, \"normals\": %s, "
             "\"notes\": [",
             (unsigned long long)file_vertex_count(s), (unsigned long long)s->mesh->triangle_count,
             shows_role(s, ROLE_NORMALS) ? "true" : "false");
    for (int n = 0; shown_notes(s, n).name; n++)
        text_add(&t, "%s\"%s=%s\"", n ? ", " : "", shown_notes(s, n).name, shown_notes(s, n).value);
    text_add(&t, "]");
    if (s->labels) list_pairs(&t, order);
    text_add(&t, "}</script>\n");
    if (t.has_failed) o->error = ENOMEM;
    output_bytes(o, t.bytes, t.length);
    text_release(&t);
}

void html_write(output *o, const shown_mesh *s) {
    label_order order;
    if (label_order_make(s, &order)) o->error = ENOMEM;
    output_bytes(o, viewer_text, strlen(viewer_text));
    write_about(o, s, &order);
    write_array(o, "positions", records_of_positions(s, 0));
    for (int n = 0; n < s->array_count; n++) {
        const shown_array shown = {s, s->arrays[n]};
        if (s->arrays[n].role == ROLE_NORMALS) write_array(o, "normals", records_of_values(&shown));
    }
    write_array(o, "triangles", records_of_ordered(s, &order));
    label_order_release(&order);
}
