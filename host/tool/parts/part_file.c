#include "part_file.h"

#include "exit_status.h"
#include "failure.h"
#include "part_digest.h"

#include <stdlib.h>
#include <string.h>

struct part_file {
    output o;
    output_group *group;
    json_t *surface; /* the layout's names */
    char *header;
    size_t header_bytes;
    part_layout layout;
    part_digest *digest;
    uint32_t *numbers; /* a block of triangles, as they are in the file */
};

enum { TRIANGLES_AT_ONCE = 1 << 16 };

static void free_part_file(part_file *p) {
    part_digest_free(p->digest);
    part_layout_release(&p->layout);
    json_decref(p->surface);
    free(p->header);
    free(p->numbers);
    free(p);
}

int part_file_open(const char *path, const part_header *header, output_group *group, part_file **file) {
    part_file *p = calloc(1, sizeof *p);
    *file = NULL;
    if (!p) return fail(STATUS_FAILED, "out of memory for a part");
    p->group = group;
    p->surface = json_incref(header->surface);
    p->numbers = malloc(TRIANGLES_AT_ONCE * 3 * sizeof *p->numbers);
    int status = p->numbers ? 0 : fail(STATUS_FAILED, "out of memory for a part");
    if (!status) status = part_header_text(header, &p->header, &p->header_bytes);
    if (!status) status = part_layout_make(path, header, p->header_bytes, &p->layout);
    if (!status && !(p->digest = part_digest_begin(&p->layout))) status = STATUS_FAILED;
    if (!status) status = output_open(&p->o, path);
    if (status) {
        free_part_file(p);
        return status;
    }
    output_rewind(&p->o);
    output_expect(&p->o, p->layout.file_bytes);
    output_bytes(&p->o, p->header, p->header_bytes);
    *file = p;
    return 0;
}

/* Writes records `first` to first + count - 1 of an array. */
static void write_array(part_file *p, int array, uint64_t first, uint64_t count, const void *values) {
    const part_array *a = &p->layout.arrays[array];
    output_seek(&p->o, a->offset + first * a->record_bytes);
    part_digest_add(p->digest, array, values, count * a->record_bytes);
    output_bytes(&p->o, values, count * a->record_bytes);
}

static int write_triangles(part_file *p, uint64_t first_vertex, uint64_t first, const tc_mesh_data *piece) {
    uint64_t largest = 0;
    for (uint64_t t = 0; t < piece->triangle_count; t += TRIANGLES_AT_ONCE) {
        const uint64_t left = piece->triangle_count - t, count = left < TRIANGLES_AT_ONCE ? left : TRIANGLES_AT_ONCE;
        for (uint64_t n = 0; n < 3 * count; n++) {
            const uint64_t vertex = first_vertex + piece->triangles[3 * t + n];
            if (vertex > largest) largest = vertex;
            p->numbers[n] = (uint32_t)vertex;
        }
        write_array(p, p->layout.array_count - 1, first + t, count, p->numbers);
    }
    if (largest <= UINT32_MAX) return 0;
    return fail(STATUS_FAILED, "%s: more than the 2^32 - 1 vertices that one part holds: make more parts", p->o.name);
}

int part_file_add(part_file *p, uint64_t first_vertex, uint64_t first_triangle, const tc_mesh_data *piece,
                  const vertex_array *fields) {
    for (int n = 0; n < p->layout.array_count - 1; n++) {
        const int channel = p->layout.arrays[n].channel;
        const float *values = channel < 0 ? fields[n - p->layout.channel_count].values : mesh_values(piece, channel);
        write_array(p, n, first_vertex, piece->vertex_count, values);
    }
    const int status = write_triangles(p, first_vertex, first_triangle, piece);
    return status ? status : output_status(&p->o);
}

int part_file_close(part_file *p) {
    char line[PART_DIGEST_BYTES + 1];
    if (!p) return 0;
    part_digest_line(p->digest, p->header, p->header_bytes, line);
    output_seek(&p->o, p->layout.digest_offset);
    output_bytes(&p->o, line, PART_DIGEST_BYTES);
    const int status = output_wait(&p->o, p->group);
    free_part_file(p);
    return status;
}

void part_file_discard(part_file *p) {
    if (!p) return;
    output_discard(&p->o);
    free_part_file(p);
}
