/*
 * mesh_simplify.c - stages, locks and trials; see mesh_simplify.h
 *
 * A stage begins with a surface without new faults, and ends with another one, or takes back what it did: so whatever
 * the library makes, what is handed out was compared. Trials of a stage end, as each locks a vertex that was not.
 *
 * A fault shows at a vertex only while all of it is there: a handle can be pinched off, and the bubble that it became
 * contracted to nothing, in one stage. Then the Euler characteristic of its component tells, but not where: small
 * components are locked whole, of others a smaller step is tried, which leaves the evidence.
 *
 * What is locked keeps more triangles than its share. Only a part of these is taken from the rest, which else would
 * lose its shape where much is locked: the goal is then not reached.
 */
#include "mesh_simplify.h"

#include "edge_contraction.h"
#include "exit_status.h"
#include "failure.h"
#include "half_edges.h"
#include "surface_faults.h"

#include <math.h>
#include <string.h>

/* What is left of the triangles by a stage, and from which on a smaller step is no use. A component of so few triangles
 * is locked whole. Trials of a stage in which locks grow by faults alone; behind them by their neighbours too. */
static const double stage_step = 0.5, smallest_step = 0.95, least_gain = 0.99;
/* Of the triangles that a stage leaves of what is free, at least that part is left where others are locked. */
static const double least_part = 0.85;
enum { SMALL_COMPONENT = 256, PLAIN_TRIALS = 6, TRIALS_MOST = 40 };

/* A surface while it is simplified: the vertices that are left, with their positions side by side. */
typedef struct stage_mesh {
    uint64_t vertex_count, triangle_count;
    float *positions;
    uint32_t *triangles, *sources;
    uint8_t *locked; /* for this stage, or for good */
} stage_mesh;

enum { FOR_STAGE = 1, FOR_GOOD = 2 };

/* One trial: what a stage makes of it. */
typedef struct trial {
    uint64_t triangle_count, kept; /* the first `kept` triangles are those at locked vertices */
    uint32_t *triangles, *free_triangles;
    uint8_t *marks;
} trial;

/* ----------------------------------------------------------------------------------------------------------- meshes */

static void stage_mesh_release(stage_mesh *m) {
    free(m->positions);
    free(m->triangles);
    free(m->sources);
    free(m->locked);
    *m = (stage_mesh){0};
}

static int stage_mesh_allocate(stage_mesh *m) {
    m->positions = array_allocate(3 * m->vertex_count, sizeof *m->positions);
    m->triangles = array_allocate(3 * m->triangle_count, sizeof *m->triangles);
    m->sources = array_allocate(m->vertex_count, sizeof *m->sources);
    m->locked = array_allocate(m->vertex_count, 1);
    if (m->positions && m->triangles && m->sources && m->locked) return 0;
    stage_mesh_release(m);
    return fail(STATUS_FAILED, "out of memory to simplify a surface of %llu triangles",
                (unsigned long long)m->triangle_count);
}

static int stage_mesh_begin(const float *positions, uint64_t vertex_count, const uint32_t *triangles,
                            uint64_t triangle_count, stage_mesh *m) {
    *m = (stage_mesh){.vertex_count = vertex_count, .triangle_count = triangle_count};
    const int status = stage_mesh_allocate(m);
    if (status) return status;
    if (vertex_count) memcpy(m->positions, positions, (size_t)(3 * vertex_count) * sizeof *positions);
    if (triangle_count) memcpy(m->triangles, triangles, (size_t)(3 * triangle_count) * sizeof *triangles);
    for (uint64_t v = 0; v < vertex_count; v++) m->sources[v] = (uint32_t)v;
    return 0;
}

/* The vertices of m that the triangles use, in their order; numbers: room for one of each vertex of m. */
static int stage_mesh_take(const stage_mesh *m, const uint32_t *triangles, uint64_t triangle_count, uint32_t *numbers,
                           stage_mesh *out) {
    uint64_t count = 0;
    for (uint64_t v = 0; v < m->vertex_count; v++) numbers[v] = NO_VERTEX;
    for (uint64_t c = 0; c < 3 * triangle_count; c++) numbers[triangles[c]] = 0;
    for (uint64_t v = 0; v < m->vertex_count; v++)
        if (numbers[v] != NO_VERTEX) numbers[v] = (uint32_t)count++;
    *out = (stage_mesh){.vertex_count = count, .triangle_count = triangle_count};
    const int status = stage_mesh_allocate(out);
    if (status) return status;
    for (uint64_t v = 0; v < m->vertex_count; v++) {
        if (numbers[v] == NO_VERTEX) continue;
        memcpy(out->positions + 3 * (uint64_t)numbers[v], m->positions + 3 * v, 3 * sizeof *m->positions);
        out->sources[numbers[v]] = m->sources[v];
        out->locked[numbers[v]] = m->locked[v] & FOR_GOOD;
    }
    for (uint64_t c = 0; c < 3 * triangle_count; c++) out->triangles[c] = numbers[triangles[c]];
    return 0;
}

/* ------------------------------------------------------------------------------------------------------------ locks */

static uint64_t hash_of(const float p[3]) {
    uint32_t bits[3];
    const float unsigned_zeros[3] = {p[0] + 0.0f, p[1] + 0.0f, p[2] + 0.0f};
    memcpy(bits, unsigned_zeros, sizeof bits);
    uint64_t hash = bits[0] * UINT64_C(0x9e3779b97f4a7c15);
    hash = (hash ^ hash >> 29 ^ bits[1]) * UINT64_C(0xbf58476d1ce4e5b9);
    hash = (hash ^ hash >> 31 ^ bits[2]) * UINT64_C(0x94d049bb133111eb);
    return hash ^ hash >> 30;
}

/* Locks vertices with a position that others have too: the library takes these for one. */
static int lock_coincident(const stage_mesh *m) {
    uint64_t size = 16;
    while (size < 2 * m->vertex_count) size *= 2;
    uint32_t *table = malloc((size_t)size * sizeof *table);
    if (!table)
        return fail(STATUS_FAILED, "out of memory for the positions of %llu vertices",
                    (unsigned long long)m->vertex_count);
    memset(table, 0xff, (size_t)size * sizeof *table); /* NO_VERTEX */
    for (uint64_t v = 0; v < m->vertex_count; v++) {
        const float *p = m->positions + 3 * v;
        uint64_t at = hash_of(p) & (size - 1);
        for (; table[at] != NO_VERTEX; at = (at + 1) & (size - 1)) {
            const float *q = m->positions + 3 * (uint64_t)table[at];
            if (p[0] != q[0] || p[1] != q[1] || p[2] != q[2]) continue;
            m->locked[v] = m->locked[table[at]] = FOR_GOOD;
            break;
        }
        if (table[at] == NO_VERTEX) table[at] = (uint32_t)v;
    }
    free(table);
    return 0;
}

static int is_fixed(const stage_mesh *m, uint64_t t) {
    const uint32_t *v = m->triangles + 3 * t;
    return m->locked[v[0]] || m->locked[v[1]] || m->locked[v[2]];
}

/* Marks the neighbours of marked vertices too. */
static void mark_neighbours(const stage_mesh *m, uint8_t *marks) {
    enum { NEW = 4 };
    for (uint64_t t = 0; t < m->triangle_count; t++) {
        const uint32_t *v = m->triangles + 3 * t;
        if ((marks[v[0]] | marks[v[1]] | marks[v[2]]) & 1)
            for (int k = 0; k < 3; k++) marks[v[k]] |= NEW;
    }
}

/* ---------------------------------------------------------------------------------------------------------- a stage */

typedef struct stage {
    const simplify_options *how;
    stage_mesh *mesh;
    surface_shape shape;
    trial trial;
    double step;
    int is_refused; /* a result was too far: steps stay small */
    double share;   /* that the stages so far leave of what is never locked */
} stage;

/* What this stage leaves of what it takes. */
static double ratio_of(const stage *s) { return fmax(s->step, s->how->share / s->share); }

/* Of the free triangles those that are to be left. */
static uint64_t free_goal_of(const stage *s, uint64_t free_count) {
    const double left = ceil(ratio_of(s) * (double)s->mesh->triangle_count) - (double)s->trial.kept;
    return (uint64_t)fmax(left, least_part * ratio_of(s) * (double)free_count);
}

static int try_contraction(stage *s) {
    const stage_mesh *m = s->mesh;
    trial *r = &s->trial;
    uint64_t free_count = 0, left = 0;
    r->kept = 0;
    for (uint64_t t = 0; t < m->triangle_count; t++) {
        uint32_t *to = is_fixed(m, t) ? r->triangles + 3 * r->kept++ : r->free_triangles + 3 * free_count++;
        memcpy(to, m->triangles + 3 * t, 3 * sizeof *to);
    }
    const uint64_t free_goal = free_goal_of(s, free_count);
    r->triangle_count = r->kept + free_count;
    if (free_count <= free_goal || !free_count) {
        memcpy(r->triangles + 3 * r->kept, r->free_triangles, (size_t)(3 * free_count) * sizeof *r->triangles);
        return 0;
    }
    const int status = edge_contraction(m->positions, m->vertex_count, r->free_triangles, free_count, free_goal,
                                        r->triangles + 3 * r->kept, &left);
    r->triangle_count = r->kept + left;
    return status;
}

/* Whether the step was too large for these faults: else vertices are locked for them. */
static int shrinks_step(stage *s, const surface_faults *faults) {
    if (faults->vertices || faults->smallest <= SMALL_COMPONENT || s->step >= smallest_step) return 0;
    s->step = sqrt(s->step);
    return 1;
}

static void lock_faults(stage *s, const surface_faults *faults, int number) {
    const int takes_all = !faults->vertices && faults->smallest > SMALL_COMPONENT;
    uint8_t *marks = s->trial.marks;
    if (number >= PLAIN_TRIALS && faults->vertices) mark_neighbours(s->mesh, marks);
    for (uint64_t v = 0; v < s->mesh->vertex_count; v++) {
        const int is_small = s->shape.triangle_counts[s->shape.roots[v]] <= SMALL_COMPONENT;
        if (marks[v] && (marks[v] != MARK_COMPONENT || is_small || takes_all)) s->mesh->locked[v] |= FOR_STAGE;
    }
}

/* Tries until there is no fault. *is_done 0: nothing came of it. */
static int run_trials(stage *s, int *is_done) {
    surface_faults faults;
    *is_done = 0;
    for (int number = 0; number < TRIALS_MOST; number++) {
        int status = try_contraction(s);
        memset(s->trial.marks, 0, (size_t)s->mesh->vertex_count);
        if (!status)
            status = surface_faults_find(&s->shape, s->trial.triangles, s->trial.triangle_count, s->how->fold_cosine,
                                         s->mesh->locked, s->trial.marks, &faults);
        if (status) return status;
        *is_done = !faults.vertices && !faults.components;
        if (*is_done) return 0;
        if (!shrinks_step(s, &faults)) lock_faults(s, &faults, number);
    }
    return 0;
}

/* Asks whether what the trial made is near enough. */
static int judge(const stage *s, const stage_mesh *made, int *is_good) {
    const simplified_mesh mesh = {made->vertex_count, made->triangle_count, made->triangles, made->sources};
    *is_good = 1;
    return s->how->judge ? s->how->judge(s->how->user, &mesh, is_good) : 0;
}

/* Replaces the mesh by what is left of it. *goes_on: there may be more to gain. */
static int finish_stage(stage *s, int *goes_on) {
    uint32_t *numbers = array_allocate(s->mesh->vertex_count, sizeof *numbers);
    const uint64_t before = s->mesh->triangle_count;
    stage_mesh made = {0};
    int is_good = 0, status = numbers ? 0 : fail(STATUS_FAILED, "out of memory for the vertices of a surface");
    if (!status) status = stage_mesh_take(s->mesh, s->trial.triangles, s->trial.triangle_count, numbers, &made);
    if (!status) status = judge(s, &made, &is_good);
    free(numbers);
    if (status || !is_good) {
        stage_mesh_release(&made);
        *goes_on = !status && s->step < smallest_step;
        s->step = sqrt(s->step);
        s->is_refused = 1;
        return status;
    }
    stage_mesh_release(s->mesh);
    *s->mesh = made;
    s->share *= ratio_of(s);
    if (!s->is_refused) s->step = stage_step;
    *goes_on = s->share > (1 + 1e-9) * s->how->share && (double)made.triangle_count < least_gain * (double)before;
    return 0;
}

static int run_stage(stage *s, int *goes_on) {
    stage_mesh *m = s->mesh;
    trial *r = &s->trial;
    int is_done = 0;
    r->triangles = array_allocate(3 * m->triangle_count, sizeof *r->triangles);
    r->free_triangles = array_allocate(3 * m->triangle_count, sizeof *r->free_triangles);
    r->marks = array_allocate(m->vertex_count, 1);
    int status = 0;
    if (!r->triangles || !r->free_triangles || !r->marks)
        status = fail(STATUS_FAILED, "out of memory to simplify %llu triangles", (unsigned long long)m->triangle_count);
    if (!status)
        status = surface_shape_take(m->positions, m->vertex_count, m->triangles, m->triangle_count, s->how->fold_cosine,
                                    m->locked, &s->shape);
    if (!status) status = run_trials(s, &is_done);
    *goes_on = 0;
    if (!status && is_done) status = finish_stage(s, goes_on);
    surface_shape_release(&s->shape);
    free(r->triangles);
    free(r->free_triangles);
    free(r->marks);
    *r = (trial){0};
    return status;
}

/* -------------------------------------------------------------------------------------------------------- the whole */

void simplified_mesh_release(simplified_mesh *mesh) {
    free(mesh->triangles);
    free(mesh->sources);
    *mesh = (simplified_mesh){0};
}

int mesh_simplify(const float *positions, uint64_t vertex_count, const uint32_t *triangles, uint64_t triangle_count,
                  const simplify_options *how, simplified_mesh *result) {
    enum { TRIANGLES_MOST = UINT32_MAX / 3 }; /* the library counts corners in 32 bits */
    stage_mesh mesh;
    stage s = {.how = how, .mesh = &mesh, .step = stage_step, .share = 1};
    *result = (simplified_mesh){0};
    if (triangle_count > TRIANGLES_MOST)
        return fail(STATUS_FAILED, "%llu triangles are more than can be simplified, %u",
                    (unsigned long long)triangle_count, (unsigned)TRIANGLES_MOST);
    int status = stage_mesh_begin(positions, vertex_count, triangles, triangle_count, &mesh);
    if (!status) status = lock_coincident(&mesh);
    for (int goes_on = triangle_count > 0; goes_on && !status;) status = run_stage(&s, &goes_on);
    if (!status) {
        *result = (simplified_mesh){mesh.vertex_count, mesh.triangle_count, mesh.triangles, mesh.sources};
        mesh.triangles = mesh.sources = NULL;
    }
    stage_mesh_release(&mesh);
    return status;
}
