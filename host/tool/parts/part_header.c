#include "part_header.h"

#include "exit_status.h"
#include "failure.h"
#include "vertex_values.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { LINE_MOST = 1 << 20, ARRAYS_MOST = 4096, COMPONENTS_MOST = 4096 };

static const char mark[] = "{\"tetracubes_part\": ";

static const int64_t count_most = INT64_C(1) << 40; /* of records: their bytes cannot overflow */

void part_planes(int64_t nz, int64_t number, int64_t count, int64_t planes[2]) {
    const int64_t layers = (nz + LAYER_PLANES - 1) / LAYER_PLANES, each = layers / count, more = layers % count;
    for (int end = 0; end < 2; end++) {
        const int64_t n = number + end, plane = LAYER_PLANES * (n * each + n * more / count);
        planes[end] = plane < nz ? plane : nz;
    }
}

/* ---------------------------------------------------------------------------------------------------------- writing */

/* Whether the text says what the object does: json_dumps leaves out a quotation mark, and says nothing, where memory
 * for it is refused (jansson 2.14). */
static int is_said(const char *line, const json_t *all) {
    json_t *read = json_loads(line, 0, NULL);
    const int is_same = read && json_equal(read, all);
    json_decref(read);
    return is_same;
}

int part_header_text(const part_header *h, char **text, size_t *bytes) {
    json_t *origin = h->has_origin ? json_pack("[f, f, f]", h->origin[0], h->origin[1], h->origin[2]) : json_null();
    json_t *all = json_pack("{s:i, s:O, s:[I, I], s:[I, I], s:I, s:I, s:o}", "tetracubes_part", PART_VERSION, "surface",
                            h->surface, "part", (json_int_t)h->number, (json_int_t)h->count, "planes",
                            (json_int_t)h->planes[0], (json_int_t)h->planes[1], "vertices", (json_int_t)h->vertex_count,
                            "triangles", (json_int_t)h->triangle_count, "origin", origin);
    char *line = all ? json_dumps(all, JSON_REAL_PRECISION(17)) : NULL;
    const size_t length = line ? strlen(line) + 1 : 0;
    if (line && !is_said(line, all)) {
        free(line);
        line = NULL;
    }
    json_decref(all);
    *bytes = (length + PART_ALIGNMENT - 1) / PART_ALIGNMENT * PART_ALIGNMENT;
    *text = line ? malloc(*bytes) : NULL;
    if (*text) {
        memset(*text, ' ', *bytes);
        memcpy(*text, line, length - 1);
        (*text)[*bytes - 1] = '\n';
    }
    free(line);
    return *text ? 0 : fail(STATUS_FAILED, "out of memory for the header of a part");
}

/* ---------------------------------------------------------------------------------------------------------- reading */

static int damaged(const char *path, const char *what) {
    return fail(STATUS_INPUT, "%s: the header of this part is damaged (%s): make it anew", path, what);
}

static int take_integers(const json_t *array, int64_t *out, size_t count) {
    if (!json_is_array(array) || json_array_size(array) != count) return 0;
    for (size_t n = 0; n < count; n++) {
        const json_t *value = json_array_get(array, n);
        if (!json_is_integer(value)) return 0;
        out[n] = json_integer_value(value);
    }
    return 1;
}

static int take_count(const json_t *value, uint64_t *out) {
    const json_int_t count = json_integer_value(value);
    *out = (uint64_t)count;
    return json_is_integer(value) && count >= 0 && count <= count_most;
}

static int take_origin(const json_t *value, part_header *h) {
    if (json_is_null(value)) return 1;
    if (!json_is_array(value) || json_array_size(value) != 3) return 0;
    for (size_t axis = 0; axis < 3; axis++) {
        const json_t *one = json_array_get(value, axis);
        h->origin[axis] = json_number_value(one);
        if (!json_is_number(one) || !isfinite(h->origin[axis])) return 0;
    }
    h->has_origin = 1;
    return 1;
}

static int take_number(const json_t *all, part_header *h) {
    int64_t part[2];
    if (!take_integers(json_object_get(all, "part"), part, 2)) return 0;
    h->number = part[0];
    h->count = part[1];
    return part[1] > 0 && part[0] >= 0 && part[0] < part[1] && part[1] <= INT32_MAX;
}

/* Whole layers; where others begin is for parts_sort to see. */
static int take_planes(const json_t *all, part_header *h) {
    int64_t dims[3];
    if (!take_integers(json_object_get(h->surface, "dims"), dims, 3) || dims[2] < 1 || dims[2] > count_most) return 0;
    if (!take_integers(json_object_get(all, "planes"), h->planes, 2)) return 0;
    for (int end = 0; end < 2; end++)
        if (h->planes[end] < 0 || h->planes[end] > dims[2] ||
            (h->planes[end] % LAYER_PLANES && h->planes[end] < dims[2]))
            return 0;
    const int is_first = h->number == 0, is_last = h->number + 1 == h->count;
    return h->planes[0] <= h->planes[1] && (!is_first || h->planes[0] == 0) && (!is_last || h->planes[1] == dims[2]);
}

static int take_all(const char *path, const json_t *all, part_header *h) {
    const json_int_t version = json_integer_value(json_object_get(all, "tetracubes_part"));
    if (version != PART_VERSION)
        return fail(STATUS_INPUT, "%s: a part's file of version %lld; this program joins version %d", path,
                    (long long)version, PART_VERSION);
    h->surface = json_incref(json_object_get(all, "surface"));
    if (!json_is_object(h->surface)) return damaged(path, "surface");
    if (!take_number(all, h)) return damaged(path, "part");
    if (!take_planes(all, h)) return damaged(path, "planes");
    if (!take_count(json_object_get(all, "vertices"), &h->vertex_count)) return damaged(path, "vertices");
    if (!take_count(json_object_get(all, "triangles"), &h->triangle_count)) return damaged(path, "triangles");
    if (h->vertex_count > UINT32_MAX) return damaged(path, "vertices");
    if (!take_origin(json_object_get(all, "origin"), h)) return damaged(path, "origin");
    return h->has_origin || !h->vertex_count ? 0 : damaged(path, "origin");
}

int part_header_read(const char *path, const unsigned char *bytes, size_t size, part_header *h, size_t *header_bytes) {
    const size_t most = size < LINE_MOST ? size : LINE_MOST;
    *h = (part_header){0};
    if (size < sizeof mark - 1 || memcmp(bytes, mark, sizeof mark - 1) != 0)
        return fail(STATUS_INPUT, "%s: no part of a surface: 'tetracubes extract --part I/N' makes such files", path);
    const unsigned char *end = memchr(bytes, '\n', most);
    if (!end && size < LINE_MOST) return fail(STATUS_INPUT, "%s: cut short within its header: make it anew", path);
    if (!end) return damaged(path, "its length");
    *header_bytes = (size_t)(end - bytes) + 1;
    if (*header_bytes % PART_ALIGNMENT) return damaged(path, "its length");
    json_t *all = json_loadb((const char *)bytes, *header_bytes, JSON_REJECT_DUPLICATES, NULL);
    const int status = all ? take_all(path, all, h) : damaged(path, "no JSON");
    json_decref(all);
    return status;
}

void part_header_release(part_header *h) {
    json_decref(h->surface);
    *h = (part_header){0};
}

/* ----------------------------------------------------------------------------------------------------------- layout */

static void add_array(part_layout *l, const char *name, int channel, int components, uint64_t count) {
    const size_t record_bytes = 4 * (size_t)components;
    l->arrays[l->array_count++] = (part_array){name, channel, components, count, record_bytes, l->digest_offset};
    l->digest_offset += count * record_bytes;
}

/* The channel of that name; -1: there is none. */
static int channel_find(const char *name) {
    for (int n = 0; name && n < CHANNEL_COUNT; n++)
        if (strcmp(mesh_channels[n].name, name) == 0) return n;
    return -1;
}

/* Positions are the first of the channels, which follow each other as in CHANNELS. */
static int add_channels(part_layout *l, const json_t *channels, uint64_t count) {
    int before = -1;
    for (size_t n = 0; n < json_array_size(channels); n++) {
        const int channel = channel_find(json_string_value(json_array_get(channels, n)));
        if (channel <= before || (n == 0 && channel != CHANNEL_POSITIONS)) return 0;
        add_array(l, mesh_channels[channel].name, channel, mesh_channels[channel].components, count);
        before = channel;
    }
    l->channel_count = l->array_count;
    return l->array_count > 0;
}

static int add_fields(part_layout *l, const json_t *fields, uint64_t count) {
    for (size_t n = 0; n < json_array_size(fields); n++) {
        const json_t *field = json_array_get(fields, n);
        const char *name = json_string_value(json_array_get(field, 0));
        const json_int_t components = json_integer_value(json_array_get(field, 1));
        if (!name || components < 1 || components > COMPONENTS_MOST) return 0;
        add_array(l, name, -1, (int)components, count);
    }
    return 1;
}

int part_layout_make(const char *path, const part_header *h, size_t header_bytes, part_layout *l) {
    const json_t *channels = json_object_get(h->surface, "channels"), *fields = json_object_get(h->surface, "carried");
    const size_t most = json_array_size(channels) + json_array_size(fields) + 1;
    *l = (part_layout){.digest_offset = header_bytes};
    if (most > ARRAYS_MOST) return damaged(path, "too many arrays");
    l->arrays = calloc(most, sizeof *l->arrays);
    if (!l->arrays) return fail(STATUS_FAILED, "out of memory for the arrays of a part");
    if (!add_channels(l, channels, h->vertex_count)) return damaged(path, "channels");
    if (!add_fields(l, fields, h->vertex_count)) return damaged(path, "carried");
    add_array(l, "triangles", -1, 3, h->triangle_count);
    l->file_bytes = l->digest_offset + PART_DIGEST_BYTES;
    return 0;
}

void part_layout_release(part_layout *l) {
    free(l->arrays);
    *l = (part_layout){0};
}
