/*
 * Labels are looked up in a hash table with open addressing. Neighbouring triangles mostly have the same, so the last
 * one found is asked first.
 */
#include "mesh_labels.h"

#include "exit_status.h"
#include "failure.h"

#include <stdlib.h>
#include <string.h>

typedef struct label_entry {
    uint32_t label; /* 0: a free entry, as the background is not looked up */
    uint64_t count;
    size_t index; /* in the sorted list */
} label_entry;

typedef struct label_table {
    label_entry *entries;
    size_t size, used, last; /* size: a power of two, or 0 */
} label_table;

static int out_of_memory(void) { return fail(STATUS_FAILED, "out of memory for the surfaces of single labels"); }

static size_t find(const label_table *t, uint32_t label) {
    size_t at = (label * (size_t)0x9e3779b97f4a7c15u >> 20) & (t->size - 1);
    while (t->entries[at].label && t->entries[at].label != label) at = (at + 1) & (t->size - 1);
    return at;
}

static int grow(label_table *t) {
    const label_table old = *t;
    t->size = old.size ? 2 * old.size : 256;
    t->entries = calloc(t->size, sizeof *t->entries);
    for (size_t n = 0; n < old.size && t->entries; n++)
        if (old.entries[n].label) t->entries[find(t, old.entries[n].label)] = old.entries[n];
    free(old.entries);
    t->last = 0;
    return t->entries ? 0 : out_of_memory();
}

/* The entry of a label, made where there is none; NULL without memory. */
static label_entry *entry_of(label_table *t, uint32_t label) {
    if (t->size && t->entries[t->last].label == label) return &t->entries[t->last];
    if (2 * t->used >= t->size && grow(t)) return NULL;
    t->last = find(t, label);
    label_entry *e = &t->entries[t->last];
    t->used += !e->label;
    e->label = label;
    return e;
}

static int count_labels(const tc_mesh_data *mesh, label_table *t) {
    for (uint64_t n = 0; n < 2 * mesh->triangle_count; n++) {
        label_entry *e = mesh->boundary_labels[n] ? entry_of(t, mesh->boundary_labels[n]) : NULL;
        if (!e && mesh->boundary_labels[n]) return STATUS_FAILED;
        if (e) e->count++;
    }
    return 0;
}

static int compare_labels(const void *a, const void *b) {
    const uint32_t x = *(const uint32_t *)a, y = *(const uint32_t *)b;
    return (x > y) - (x < y);
}

/* The sorted list, with room for the triangles of each label. */
static int make_list(label_table *t, mesh_labels *out) {
    out->labels = malloc((t->used + 1) * sizeof *out->labels);
    out->starts = calloc(t->used + 1, sizeof *out->starts);
    if (!out->labels || !out->starts) return out_of_memory();
    for (size_t n = 0; n < t->size; n++)
        if (t->entries[n].label) out->labels[out->count++] = t->entries[n].label;
    qsort(out->labels, out->count, sizeof *out->labels, compare_labels);
    for (size_t n = 0; n < out->count; n++) {
        label_entry *e = &t->entries[find(t, out->labels[n])];
        e->index = n;
        out->starts[n + 1] = out->starts[n] + e->count;
        e->count = out->starts[n]; /* from here on: where its next triangle goes */
    }
    out->triangles = malloc(((size_t)out->starts[out->count] + 1) * sizeof *out->triangles);
    out->numbers = calloc((size_t)out->mesh->vertex_count + 1, sizeof *out->numbers);
    return out->triangles && out->numbers ? 0 : out_of_memory();
}

int mesh_labels_find(const tc_mesh_data *mesh, mesh_labels *out) {
    label_table t = {0};
    *out = (mesh_labels){.mesh = mesh};
    int status = count_labels(mesh, &t);
    if (!status) status = make_list(&t, out);
    for (uint64_t n = 0; n < 2 * mesh->triangle_count && !status; n++)
        if (mesh->boundary_labels[n]) out->triangles[entry_of(&t, mesh->boundary_labels[n])->count++] = n / 2;
    free(t.entries);
    return status;
}

int mesh_labels_has(const mesh_labels *l, uint32_t label) {
    return l->count && bsearch(&label, l->labels, l->count, sizeof label, compare_labels) != NULL;
}

void mesh_labels_release(mesh_labels *l) {
    free(l->labels);
    free(l->starts);
    free(l->triangles);
    free(l->numbers);
    *l = (mesh_labels){0};
}

static int reserve(label_mesh *m, uint64_t triangles) {
    const uint64_t vertices = 3 * triangles; /* at most */
    if (triangles <= m->triangle_capacity) return 0;
    label_mesh_release(m);
    m->positions = malloc((size_t)vertices * 3 * sizeof *m->positions);
    m->triangles = malloc((size_t)triangles * 3 * sizeof *m->triangles);
    m->labels = malloc((size_t)triangles * 2 * sizeof *m->labels);
    if (!m->positions || !m->triangles || !m->labels) return out_of_memory();
    m->triangle_capacity = triangles;
    return 0;
}

static void take_triangle(mesh_labels *l, uint32_t label, uint64_t triangle, label_mesh *out) {
    const uint32_t *labels = l->mesh->boundary_labels + 2 * triangle, *from = l->mesh->triangles + 3 * triangle;
    const int is_first = labels[0] == label;
    const uint64_t n = out->mesh.triangle_count++;
    for (unsigned c = 0; c < 3; c++) {
        const uint32_t vertex = from[is_first ? c : (3 - c) % 3];
        if (!l->numbers[vertex]) {
            const uint64_t number = out->mesh.vertex_count++;
            memcpy(out->positions + 3 * number, l->mesh->positions + 3 * (uint64_t)vertex, 3 * sizeof(float));
            l->numbers[vertex] = (uint32_t)number + 1;
        }
        out->triangles[3 * n + c] = l->numbers[vertex] - 1;
    }
    out->labels[2 * n] = label;
    out->labels[2 * n + 1] = labels[is_first];
}

int mesh_label_take(mesh_labels *l, size_t n, label_mesh *out) {
    const uint64_t *first = l->triangles + l->starts[n], count = l->starts[n + 1] - l->starts[n];
    const int status = reserve(out, count);
    out->mesh = (tc_mesh_data){.struct_size = sizeof out->mesh};
    if (status) return status;
    for (uint64_t t = 0; t < count; t++) take_triangle(l, l->labels[n], first[t], out);
    for (uint64_t t = 0; t < count; t++)
        for (unsigned c = 0; c < 3; c++) l->numbers[l->mesh->triangles[3 * first[t] + c]] = 0;
    out->mesh.positions = out->positions;
    out->mesh.triangles = out->triangles;
    out->mesh.boundary_labels = out->labels;
    memcpy(out->mesh.origin, l->mesh->origin, sizeof out->mesh.origin);
    return 0;
}

void label_mesh_release(label_mesh *m) {
    free(m->positions);
    free(m->triangles);
    free(m->labels);
    *m = (label_mesh){0};
}
