#include "part_surface.h"

#include "exit_status.h"
#include "failure.h"
#include "terminal/json_report.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#define XXH_INLINE_ALL
#include <xxhash.h>

/* Bytes of samples that are hashed: so many pieces of so many bytes. */
enum { HASHED_PIECES = 64, PIECE_BYTES = 4096 };

static uint64_t hash_pieces(const void *values, uint64_t bytes, uint64_t seed) {
    const uint64_t step = bytes / HASHED_PIECES;
    if (!values || bytes <= HASHED_PIECES * PIECE_BYTES) return values ? XXH64(values, bytes, seed) : seed;
    for (uint64_t n = 0; n < HASHED_PIECES; n++) {
        const uint64_t at = n + 1 < HASHED_PIECES ? n * step : bytes - PIECE_BYTES;
        seed = XXH64((const char *)values + at, PIECE_BYTES, seed);
    }
    return seed;
}

static uint64_t hash_grid(const tc_grid_options *g) {
    uint64_t hash = XXH64(g->matrix, sizeof g->matrix, 0);
    hash = XXH64(g->first_index, sizeof g->first_index, hash);
    for (int axis = 0; axis < 3; axis++) {
        const size_t count = (size_t)g->dims[axis];
        if (g->axes[axis]) hash = XXH64(g->axes[axis], count * sizeof *g->axes[axis], hash);
        if (g->axes_f64[axis]) hash = XXH64(g->axes_f64[axis], count * sizeof *g->axes_f64[axis], hash);
    }
    const uint64_t points = (uint64_t)(g->dims[0] * g->dims[1] * g->dims[2]);
    hash = hash_pieces(g->points, points * 3 * sizeof *g->points, hash);
    return hash_pieces(g->points_f64, points * 3 * sizeof *g->points_f64, hash);
}

static json_t *hash_json(uint64_t hash) {
    char text[24];
    snprintf(text, sizeof text, "%016" PRIx64, hash);
    return json_string(text);
}

static json_t *input_json(const options *o, const tc_grid_options *g, const void *samples, const uint8_t *blanked) {
    const uint64_t points = (uint64_t)(g->dims[0] * g->dims[1] * g->dims[2]);
    json_t *bytes = json_array();
    struct stat file;
    int failed = 0;
    for (int n = 0; n < o->operand_count; n++)
        if (stat(o->operands[n], &file) == 0 && S_ISREG(file.st_mode))
            failed |= json_array_append_new(bytes, json_integer((json_int_t)file.st_size));
    const uint64_t content = hash_pieces(blanked, points, hash_pieces(samples, points * tc_type_bytes(g->type), 0));
    json_t *input = json_object();
    failed |= json_object_set_new(input, "file_bytes", bytes);
    failed |= json_object_set_new(input, "grid", hash_json(hash_grid(g)));
    failed |= json_object_set_new(input, "samples", hash_json(content));
    if (!failed) return input;
    json_decref(input);
    return NULL;
}

static json_t *channels_json(const tc_extract_options *how) {
    json_t *names = json_array();
    int failed = 0;
    for (int n = 0; n < CHANNEL_COUNT; n++)
        if (channel_is_asked(how, n)) failed |= json_array_append_new(names, json_string(mesh_channels[n].name));
    if (!failed) return names;
    json_decref(names);
    return NULL;
}

/* Names and components; NULL, with its message, where a name is no text that JSON holds. */
static json_t *carried_json(const carried_fields *c) {
    json_t *list = json_array();
    int failed = !list;
    for (int n = 0; n < c->count && !failed; n++) {
        json_t *name = json_string(c->fields[n].name);
        if (!name) {
            json_decref(list);
            fail(STATUS_USAGE, "--part: the name of the field '%s' is no UTF-8, which a part's file holds",
                 c->fields[n].name);
            return NULL;
        }
        failed = json_array_append_new(list, json_pack("[o, i]", name, c->fields[n].components));
    }
    if (!failed) return list;
    json_decref(list);
    fail(STATUS_FAILED, "out of memory for the header of a part");
    return NULL;
}

json_t *part_surface_make(const options *o, const dataset *d, const scalar *field, const carried_fields *carried,
                          const tc_grid_options *grid, const tc_extract_options *how, const void *samples,
                          const uint8_t *blanked_samples, int suits_world) {
    json_t *fields_carried = carried_json(carried);
    if (!fields_carried) return NULL;
    json_t *surface = json_object(); /* set_new takes what it is given, also where it fails */
    int failed = json_object_set_new(surface, "version", json_string(tc_version()));
    failed |= json_object_set_new(surface, "world", json_string(d->world));
    failed |= json_object_set_new(surface, "units", json_string(d->units));
    failed |= json_object_set_new(surface, "suits_world", json_boolean(suits_world));
    failed |= json_object_set_new(surface, "dims", integers_json(grid->dims));
    failed |= json_object_set_new(surface, "type", json_string(tc_type_name(grid->type)));
    failed |= json_object_set_new(surface, "field", string_json(field->name));
    failed |= json_object_set_new(surface, "component", json_integer(field->component));
    failed |= json_object_set_new(surface, "isovalue", json_real(how->isovalue));
    failed |= json_object_set_new(surface, "method", json_string(tc_method_name(how->method)));
    failed |= json_object_set_new(surface, "snap",
                                  how->method == TC_METHOD_SNAP ? json_real((double)how->snap) : json_null());
    failed |= json_object_set_new(surface, "closed", json_boolean(how->closed));
    failed |= json_object_set_new(surface, "nodata", o->has_nodata ? json_real(o->nodata) : json_null());
    failed |= json_object_set_new(surface, "channels", channels_json(how));
    failed |= json_object_set_new(surface, "carried", fields_carried);
    failed |= json_object_set_new(surface, "input", input_json(o, grid, samples, blanked_samples));
    if (!failed) return surface;
    json_decref(surface);
    fail(STATUS_FAILED, "out of memory for the header of a part");
    return NULL;
}
