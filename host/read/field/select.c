#include "field/select.h"

#include "dataset/region.h"
#include "exit_status.h"
#include "failure.h"
#include "field/average.h"
#include "field/magnitude.h"
#include "field/nodata.h"
#include "sample_types.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ----------------------------------------------------------------------------------------------------------- names */

/* What the values of a field belong to. ANY: points, or cells where no field of the name is at points. */
enum association { ANY_ASSOCIATION = -1, AT_POINTS, ON_CELLS };

typedef struct choice {
    const char *name; /* NULL: none */
    enum association association;
    int is_active; /* made by the file: its active scalars */
} choice;

static const dataset_field *chosen_field(const dataset_block *b, choice c) {
    const dataset_field *found = NULL;
    for (int n = 0; n < b->field_count; n++) {
        const dataset_field *f = &b->fields[n];
        int fits = strcmp(f->name, c.name) == 0 &&
                   (c.association == ANY_ASSOCIATION || f->on_cells == (c.association == ON_CELLS));
        if (fits && (!found || (found->on_cells && !f->on_cells))) found = f;
    }
    return found;
}

const dataset_field *block_field(const dataset_block *b, const char *name) {
    return chosen_field(b, (choice){name, ANY_ASSOCIATION, 0});
}

static int is_common(const dataset *d, choice c) {
    for (int n = 0; n < d->block_count; n++)
        if (!chosen_field(&d->blocks[n], c)) return 0;
    return 1;
}

int common_field_names(const dataset *d, const char ***names) {
    const dataset_block *first = d->blocks;
    int count = 0;
    *names = malloc(sizeof **names * (size_t)(d->block_count ? first->field_count + 1 : 1));
    if (!*names) return fail(STATUS_FAILED, "no memory for the names of fields"), -1;
    for (int n = 0; d->block_count && n < first->field_count; n++) {
        const char *name = first->fields[n].name;
        int is_new = 1;
        for (int m = 0; m < count; m++) is_new = is_new && strcmp((*names)[m], name) != 0;
        if (is_new && is_common(d, (choice){name, ANY_ASSOCIATION, 0})) (*names)[count++] = name;
    }
    return count;
}

size_t field_prefix(const char *text) {
    static const char *const prefixes[] = {"point:", "cell:"};
    for (int n = 0; n < 2; n++)
        if (strncmp(text, prefixes[n], strlen(prefixes[n])) == 0) return strlen(prefixes[n]);
    return 0;
}

/* The choice that a string makes: of the field of exactly this name, or, after point: or cell:, of one there. */
static choice find_choice(const dataset *d, const char *const *names, int count, const char *text) {
    const size_t prefix = field_prefix(text);
    for (int n = 0; n < count; n++)
        if (strcmp(names[n], text) == 0) return (choice){names[n], ANY_ASSOCIATION, 0};
    if (count == 1 && !names[0][0] && strcmp(text, FIELD_WITHOUT_NAME) == 0)
        return (choice){names[0], ANY_ASSOCIATION, 0};
    for (int n = 0; n < count && prefix; n++) {
        const choice c = {names[n], text[0] == 'c' ? ON_CELLS : AT_POINTS, 0};
        if (strcmp(names[n], text + prefix) == 0 && is_common(d, c)) return c;
    }
    return (choice){NULL, ANY_ASSOCIATION, 0};
}

/* The file's active scalars, of points before those of cells, where every block has such a field. */
static choice active_choice(const dataset *d) {
    choice c = {NULL, ANY_ASSOCIATION, 0};
    for (int n = 0; d->block_count && n < d->blocks->field_count; n++) {
        const dataset_field *f = &d->blocks->fields[n];
        const choice own = {f->name, f->on_cells ? ON_CELLS : AT_POINTS, 1};
        if (f->is_active && (!c.name || c.association > own.association) && is_common(d, own)) c = own;
    }
    return c;
}

/* Adds "density (point)" or "velocity (point, 3 components)" to a list; "cell:density (cell)" of a field that its name
 * alone does not choose. The list ends with ", ..." where it has no room. */
static void list_field(const dataset *d, choice c, char *text, size_t bytes) {
    const dataset_field *f = chosen_field(d->blocks, c);
    size_t used = strlen(text);
    char one[256], components[32] = "";
    if (f->components > 1) snprintf(components, sizeof components, ", %d components", f->components);
    snprintf(one, sizeof one, "%s%s%s (%s%s)", used ? ", " : "", c.association == ON_CELLS ? "cell:" : "", c.name,
             f->on_cells ? "cell" : "point", components);
    int is_full = used >= 5 && strcmp(text + used - 5, ", ...") == 0;
    if (is_full) return;
    snprintf(text + used, bytes - used, "%s", used + strlen(one) + 8 > bytes ? ", ..." : one);
}

static void list_fields(const dataset *d, const char *const *names, int count, char *text, size_t bytes) {
    text[0] = '\0';
    for (int n = 0; n < count; n++) {
        const choice cells = {names[n], ON_CELLS, 0};
        list_field(d, (choice){names[n], ANY_ASSOCIATION, 0}, text, bytes);
        if (!block_field(d->blocks, names[n])->on_cells && is_common(d, cells)) list_field(d, cells, text, bytes);
    }
}

/* An array of that name that was left out; any such array where name is NULL. NULL: none. */
static const dataset_absent *find_absent(const dataset *d, const char *name) {
    for (int n = 0; n < d->absent_count; n++)
        if (!name || !strcmp(d->absent[n].name, name) || !strcmp(d->absent[n].name, name + field_prefix(name)))
            return &d->absent[n];
    return NULL;
}

/* A field that every block has, or why there is none. */
static int choose(const dataset *d, const char *path, const char *option, const char *wanted, choice *out) {
    const char **names;
    char list[700];
    int status = 0, count = common_field_names(d, &names);
    if (count < 0) return STATUS_FAILED;
    list_fields(d, names, count, list, sizeof list);
    *out = wanted ? find_choice(d, names, count, wanted) : (choice){count ? names[0] : NULL, ANY_ASSOCIATION, 0};
    const choice active = active_choice(d);
    if (!wanted && count > 1 && active.name) *out = active;
    const int is_unknown = wanted && !out->name;
    const dataset_absent *absent = is_unknown ? find_absent(d, wanted) : NULL;
    if (!count && !absent) absent = find_absent(d, NULL);
    if (absent)
        status = fail(STATUS_INPUT, "%s: %sthe array '%.60s' is left out: %s", path,
                      count ? "" : "holds no field that can be read: ", absent->name, absent->reason);
    else if (!count)
        status =
            fail(STATUS_INPUT, "%s: holds no field%s: there is nothing to contour%s", path,
                 d->block_count > 1 ? " that every block has" : "",
                 strcmp(d->format, "Plot3D") ? "" : "; a Plot3D grid's values are in its solution: name both files");
    else if (is_unknown && count == 1 && !names[0][0])
        status =
            fail(STATUS_USAGE,
                 "%s: no field is named '%s': its only one has no name: leave out %.*s, or call it " FIELD_WITHOUT_NAME,
                 path, wanted, (int)strcspn(option, " "), option);
    else if (is_unknown)
        status = fail(STATUS_USAGE, "%s: no field%s is named '%s'; %s one of: %s", path,
                      d->block_count > 1 ? " of every block" : "", wanted, option, list);
    else if (!wanted && count > 1 && !active.name)
        status = fail(STATUS_USAGE, "%s: holds several fields: choose by --field NAME one of: %s", path, list);
    free(names);
    return status;
}

/* --------------------------------------------------------------------------------------------------------- samples */

/* The tuples of a field's array, also where cells of the block are left out. */
static uint64_t tuple_count(const dataset_block *b, const dataset_field *f) {
    return (uint64_t)(f->on_cells ? b->cell_count : b->point_count);
}

static int check_component(const dataset *d, const char *path, const dataset_field *f, int component) {
    if (component == COMPONENT_OPEN && f->components > 1)
        return fail(STATUS_USAGE,
                    "%s: field '%s' has %d components: choose by --component C one, from 0 to %d, or their length by "
                    "--component magnitude",
                    path, f->name, f->components, f->components - 1);
    if (component == COMPONENT_MAGNITUDE && f->components == 1)
        return fail(STATUS_USAGE, "%s: field '%s' has 1 component, no vectors: leave out --component magnitude", path,
                    f->name);
    if (component >= f->components && !d->frames) /* the readers of images have checked it */
        return fail(STATUS_USAGE, "%s: field '%s' has %d component%s, counted from 0: there is no --component %d", path,
                    f->name, f->components, f->components > 1 ? "s" : "", component);
    return 0;
}

/* *out: one component in contiguous memory, or the length of all; the field itself where it has one component. */
static int take_component(dataset *d, const dataset_block *b, const dataset_field *f, int component,
                          dataset_field *out) {
    *out = *f;
    if (f->components == 1) return 0;
    int is_length = component == COMPONENT_MAGNITUDE;
    out->type = is_length ? magnitude_type(f->type) : f->type;
    out->components = 1;
    size_t bytes = sample_bytes(out->type), stride = bytes * (size_t)f->components;
    uint64_t count = tuple_count(b, f);
    unsigned char *values = dataset_allocate(d, count * bytes);
    if (!values) return STATUS_FAILED;
    out->values = values;
    if (is_length) {
        magnitude_of(f->type, f->values, f->components, count, values);
        return 0;
    }
    const unsigned char *from = (const unsigned char *)f->values + bytes * (size_t)component;
    for (uint64_t n = 0; n < count; n++) memcpy(values + n * bytes, from + n * stride, bytes);
    return 0;
}

/* The missing value, as values of a field, or all components of its vectors, are compared with it. */
typedef struct missing_value {
    int is_there;
    double value;
    const dataset_field *of; /* whose values are compared: of lengths, the vectors that they are made of */
} missing_value;

static int equals(const dataset_field *f, uint64_t n, double value) {
    const double own = value_at(f->type, f->values, n);
    return f->is_scaled ? nodata_is_scaled(own, value) : own == value;
}

/* The first of count values that equals the missing one; count where none does. */
static uint64_t find_equal(const dataset_field *f, uint64_t count, double value) {
    uint64_t n = 0;
    if (!f->is_scaled) return nodata_find(f->type, f->values, count, value);
    while (n < count && !equals(f, n, value)) n++;
    return n;
}

/* The request's nodata, where some value of the field equals it. */
static missing_value find_nodata(const dataset_block *b, const dataset_field *f, const read_request *request) {
    const uint64_t count = tuple_count(b, f) * (uint64_t)f->components;
    missing_value m = {.of = f};
    m.is_there = nodata_of_type(f->type, request->nodata, &m.value) && request->has_nodata &&
                 find_equal(f, count, m.value) < count;
    return m;
}

static int is_missing(const dataset_field *f, uint64_t n, const missing_value *nodata) {
    const uint64_t components = (uint64_t)nodata->of->components;
    if (!isfinite(value_at(f->type, f->values, n))) return 1;
    for (uint64_t c = 0; c < components && nodata->is_there; c++)
        if (equals(nodata->of, n * components + c, nodata->value)) return 1;
    return 0;
}

/* Adds the points or cells whose value is missing to a mask, which may be NULL. *mask stays where none is missing. */
static int mask_missing(dataset *d, const dataset_block *b, const dataset_field *f, const missing_value *nodata,
                        const uint8_t **mask) {
    uint64_t count = tuple_count(b, f), n = 0;
    int may_be_missing = nodata->is_there || type_is_real(f->type);
    while (may_be_missing && n < count && !is_missing(f, n, nodata)) n++;
    if (!may_be_missing || n == count) return 0;
    uint8_t *merged = dataset_allocate(d, count);
    if (!merged) return STATUS_FAILED;
    for (n = 0; n < count; n++) merged[n] = (*mask && (*mask)[n]) || is_missing(f, n, nodata);
    *mask = merged;
    return 0;
}

static int scalar_of_block(dataset *d, const dataset_block *b, const dataset_field *f, const read_request *request,
                           scalar_block *out, int *has_nodata) {
    dataset_field one, at_points;
    *out = (scalar_block){.blanked_points = b->blanked_points, .blanked_cells = b->blanked_cells};
    int status = take_component(d, b, f, request->component, &one);
    if (status) return status;
    const missing_value nodata = find_nodata(b, request->component == COMPONENT_MAGNITUDE ? f : &one, request);
    const int is_value = !nodata.of->is_scaled && nodata.of->components == 1; /* samples equal it exactly */
    *has_nodata |= nodata.is_there;
    if (f->on_cells) {
        status = mask_missing(d, b, &one, &nodata, &out->blanked_cells);
        if (!status) status = average_to_points(d, b, out->blanked_cells, &one, &at_points);
        if (status) return status;
        one = at_points;
    } else if (b->kind == BLOCK_UNSTRUCTURED || (nodata.is_there && !is_value)) {
        if ((status = mask_missing(d, b, &one, &nodata, &out->blanked_points))) return status;
    } else {
        out->has_nodata = nodata.is_there;
        out->nodata = nodata.value;
    }
    out->type = one.type;
    out->samples = one.values;
    return 0;
}

/* Of a part: its values, or, of cells, the averages of the whole at its points. */
static int scalar_of_part(dataset *d, const dataset_block *b, const dataset_field *f, const read_request *request,
                          scalar_block *out, int *has_nodata) {
    dataset_field own;
    dataset_block around;
    sample_box inner;
    if (!f->on_cells || !f->is_whole) {
        int status = region_field(d, b, f, &own);
        return status ? status : scalar_of_block(d, b, &own, request, out, has_nodata);
    }
    int status = region_around(d, b, f, &around, &own, &inner);
    if (!status) status = scalar_of_block(d, &around, &own, request, out, has_nodata);
    if (!status) status = region_points(d, around.dims, out->type, 1, &inner, &out->samples);
    if (!status) status = region_blanked_cells(d, around.dims, &inner, &out->blanked_cells);
    out->blanked_points = b->blanked_points;
    return status;
}

int scalar_select(dataset *d, const read_request *request, scalar *out) {
    *out = (scalar){.component = -1};
    choice chosen;
    int status = choose(d, request->path, "--field takes", request->field, &chosen);
    if (status) return status;
    out->name = chosen.name;
    out->is_active = chosen.is_active;
    out->blocks = dataset_allocate(d, (uint64_t)d->block_count * sizeof *out->blocks);
    if (!out->blocks) return STATUS_FAILED;
    for (int n = 0; n < d->block_count && !status; n++) {
        const dataset_field *f = chosen_field(&d->blocks[n], chosen);
        status = check_component(d, request->path, f, request->component);
        if (!status) status = scalar_of_part(d, &d->blocks[n], f, request, &out->blocks[n], &out->has_nodata);
        if (f->components > 1) out->component = request->component;
        out->is_rounded |= f->is_rounded;
        out->is_averaged |= f->on_cells;
    }
    return status;
}

int scalar_field(const dataset *d, const read_request *request, const dataset_field **out) {
    const char **names;
    int status, count = common_field_names(d, &names);
    choice chosen;
    *out = NULL;
    if (count < 0) return STATUS_FAILED;
    free(names);
    if (!request->field && count != 1 && !active_choice(d).name) return 0;
    if ((status = choose(d, request->path, "--field takes", request->field, &chosen))) return status;
    *out = chosen_field(d->blocks, chosen);
    return 0;
}

int scalar_components(const dataset *d, const read_request *request, int *components) {
    const dataset_field *f;
    const int status = scalar_field(d, request, &f);
    *components = f ? f->components : 0;
    return status;
}

const char *active_field(const dataset *d) { return active_choice(d).name; }

/* The field at the points of a block. */
static int field_at_points(dataset *d, const dataset_block *b, const dataset_field *f, dataset_field *out) {
    dataset_field own;
    dataset_block around;
    sample_box inner;
    if (!f->on_cells) return region_field(d, b, f, out);
    if (!f->is_whole) return average_to_points(d, b, b->blanked_cells, f, out);
    int status = region_around(d, b, f, &around, &own, &inner);
    if (!status) status = average_to_points(d, &around, around.blanked_cells, &own, out);
    return status ? status : region_points(d, around.dims, out->type, out->components, &inner, &out->values);
}

int point_field_select(dataset *d, const char *path, const char *name, point_field *out) {
    *out = (point_field){0};
    choice chosen;
    int status = choose(d, path, "--carry takes", name, &chosen);
    if (status) return status;
    out->name = chosen.association != ANY_ASSOCIATION ? dataset_text(d, name)
                : *chosen.name                        ? chosen.name
                                                      : FIELD_WITHOUT_NAME;
    if (!out->name) return STATUS_FAILED;
    out->blocks = dataset_allocate(d, (uint64_t)d->block_count * sizeof *out->blocks);
    if (!out->blocks) return STATUS_FAILED;
    for (int n = 0; n < d->block_count && !status; n++) {
        const dataset_block *b = &d->blocks[n];
        const dataset_field *f = chosen_field(b, chosen);
        if (n && f->components != out->components)
            return fail(STATUS_INPUT, "%s: field '%s' has %d components in block 0, %d in block %d", path, name,
                        out->components, f->components, n);
        out->components = f->components;
        out->is_averaged |= f->on_cells;
        status = field_at_points(d, b, f, &out->blocks[n]);
    }
    return status;
}
