/*
 * vertex.cl - position and normal of one vertex, after crossing.cl; host/lib/reference/reference_vertex.inc is its twin
 *
 * From the build: REAL, SAMPLE_VALUE(bits), NORMALS, GRID (0: uniform, 1: rectilinear, 2: curvilinear).
 */
#ifndef VERTEX_CL
#define VERTEX_CL

#include "../base/crossing.cl"
#include "../base/words.cl"

/* The arrays of a grid that have an item per sample or coordinate. */
typedef struct grid_arrays {
    global const BITS *samples;
    global const float *coordinates; /* rectilinear: positions along x, y, z; curvilinear: points */
    global const uchar *blanked;     /* samples */
} grid_arrays;

/* An edge in one word. Bits 0-6, 7-10, 11-13: x, y, z of its first end, counted from edges_origin (mesh.cl). Then two
 * bits for each axis: the step to its other end, -1, 0 or 1, plus 1. */
#define EDGE_CODE(x, y, z, step_x, step_y, step_z)                                                                     \
    ((uint)(x) | (uint)(y) << 7 | (uint)(z) << 11 | (uint)((step_x) + 1) << 14 | (uint)((step_y) + 1) << 16 |          \
     (uint)((step_z) + 1) << 18)

#ifdef REAL

#if GRID == 0
/* The position on the edge at t, in world space. */
inline_always void position_make(const slab *s, grid_index origin, uint edge, float t, float out[3]) {
    int step_x = (int)(edge >> 14 & 3) - 1, step_y = (int)(edge >> 16 & 3) - 1, step_z = (int)(edge >> 18 & 3) - 1;
    float x = (float)(s->first[0] + (int)(origin.x + (edge & 0x7f))) + (float)step_x * t;
    float y = (float)(s->first[1] + (int)(origin.y + (edge >> 7 & 0xf))) + (float)step_y * t;
    float z = (float)(s->first[2] + (int)(origin.z + (edge >> 11 & 7))) + (float)step_z * t;
    const float *m = s->space.matrix;
    out[0] = ((m[0] * x + m[1] * y) + m[2] * z) + m[3];
    out[1] = ((m[4] * x + m[5] * y) + m[6] * z) + m[7];
    out[2] = ((m[8] * x + m[9] * y) + m[10] * z) + m[11];
}
#else
/* The position on the edge at t, between the points of its ends. The edge's samples are at `from` and `from` + `step`
 * in the sample buffer. */
inline_always void position_between(const slab *s, grid_arrays in, grid_index origin, uint edge, ulong from, long step,
                                    float t, float out[3]) {
#if GRID == 1
    global const float *x = in.coordinates + (origin.x + (edge & 0x7f));
    global const float *y = in.coordinates + s->nx + (origin.y + (edge >> 7 & 0xf));
    global const float *z = in.coordinates + s->nx + s->ny + (origin.z + (edge >> 11 & 7));
    float3 p0 = (float3)(*x, *y, *z);
    float3 p1 = (float3)(x[(int)(edge >> 14 & 3) - 1], y[(int)(edge >> 16 & 3) - 1], z[(int)(edge >> 18 & 3) - 1]);
#else
    global const float *points = in.coordinates + (3 * from + s->arrays.point_offset);
    float3 p0 = vload3(0, points), p1 = vload3(step, points);
#endif
    vstore3(t == 1 ? p1 : p0 + t * (p1 - p0), 0, out);
}
#endif

#if NORMALS

/* The two samples whose difference along an axis is taken: central; one-sided at borders and beside missing samples;
 * the same sample twice, so 0, where both sides are a border or missing. Functions get it by address: in a loop
 * Mesa loses what is copied. */
typedef struct neighbours {
    ulong before, after; /* in the sample buffer */
    uint first, last;    /* along the axis */
    float weight;        /* 1/32 or 1/16 in place of 1/2 or 1, so that products of differences do not overflow */
} neighbours;

inline_always bool neighbour_missing(grid_arrays in, const slab *s, ulong n) {
#if MISSING
    return sample_missing(in.samples, in.blanked, s, n);
#else
    return false;
#endif
}

/* One of three, selected by axis: with a variable index the compiler would put them into memory. */
#define OF_AXIS(axis, x, y, z) ((axis) == 0 ? (x) : (axis) == 1 ? (y) : (z))

inline_always neighbours neighbours_of(grid_arrays in, const slab *s, const uint p[3], uint axis) {
    const uint at = OF_AXIS(axis, p[0], p[1], p[2]), end = OF_AXIS(axis, s->nx, s->ny, s->nz);
    const ulong stride = OF_AXIS(axis, 1ul, (ulong)s->nx, (ulong)s->nx * s->ny);
    ulong here = row_start(s, p[1], p[2]) + p[0];
    bool has_before = at > 0 && !neighbour_missing(in, s, here - stride);
    bool has_after = at + 1 < end && !neighbour_missing(in, s, here + stride);
    neighbours n = {has_before ? here - stride : here, has_after ? here + stride : here, at - has_before,
                    at + has_after, has_before && has_after ? 0.03125f : 0.0625f};
    return n;
}

inline_always REAL sample_difference(grid_arrays in, const neighbours *n) {
    REAL weight = n->weight;
    return weight * SAMPLE_VALUE(in.samples[n->after]) - weight * SAMPLE_VALUE(in.samples[n->before]);
}

inline_always REAL largest_of(const REAL v[3]) {
    REAL x = v[0] < 0 ? -v[0] : v[0], y = v[1] < 0 ? -v[1] : v[1], z = v[2] < 0 ? -v[2] : v[2];
    REAL largest = x > y ? x : y;
    return largest > z ? largest : z;
}

#if GRID

inline_always REAL coordinate_difference(grid_arrays in, const slab *s, const neighbours *n, uint axis, uint row) {
    REAL weight = n->weight;
#if GRID == 1
    global const float *positions = in.coordinates + OF_AXIS(axis, 0, s->nx, s->nx + s->ny);
    return weight * (REAL)positions[n->last] - weight * (REAL)positions[n->first];
#else
    global const float *points = in.coordinates + row;
    return weight * (REAL)points[3 * n->after + s->arrays.point_offset] -
           weight * (REAL)points[3 * n->before + s->arrays.point_offset];
#endif
}

/* The gradient g in index space, negated, becomes a direction n in world space; j[axis] is how positions change
 * along an axis. The inverse transposed Jacobian is its cofactors over its determinant, of which only the sign matters.
 * Columns are scaled to a largest element of 1, and g against that, so that cells may be flat. Zero where the
 * determinant is. */
inline_always void gradient_map(REAL j[3][3], REAL g[3], REAL n[3]) {
    REAL size[3], c[3][3];
#pragma unroll
    for (uint axis = 0; axis < 3; axis++) size[axis] = largest_of(j[axis]);
    REAL least = size[0] < size[1] ? size[0] : size[1];
    least = least < size[2] ? least : size[2];
    n[0] = n[1] = n[2] = 0;
    if (!(least > 0)) return;
#pragma unroll
    for (uint axis = 0; axis < 3; axis++) {
#pragma unroll
        for (uint row = 0; row < 3; row++) j[axis][row] = DIVIDE(j[axis][row], size[axis]);
        g[axis] *= DIVIDE(least, size[axis]);
    }
#pragma unroll
    for (uint axis = 0; axis < 3; axis++) {
        const REAL *u = j[(axis + 1) % 3], *v = j[(axis + 2) % 3];
#pragma unroll
        for (uint row = 0; row < 3; row++)
            c[axis][row] = u[(row + 1) % 3] * v[(row + 2) % 3] - u[(row + 2) % 3] * v[(row + 1) % 3];
    }
    REAL determinant = (j[0][0] * c[0][0] + j[0][1] * c[0][1]) + j[0][2] * c[0][2];
    REAL sign = determinant > 0 ? (REAL)-1 : determinant < 0 ? (REAL)1 : (REAL)0;
#pragma unroll
    for (uint row = 0; row < 3; row++) n[row] = sign * ((c[0][row] * g[0] + c[1][row] * g[1]) + c[2][row] * g[2]);
}

#endif

/* Unit length, towards lower values; zero where the gradient vanishes. Gradient and Jacobian are made of the same
 * differences, and interpolated along the edge. */
inline_always void normal_store(grid_arrays in, const slab *s, grid_index origin, uint edge, float t,
                                global float *out) {
    const uint a[3] = {origin.x + (edge & 0x7f), origin.y + (edge >> 7 & 0xf), origin.z + (edge >> 11 & 7)};
    const uint b[3] = {a[0] + (edge >> 14 & 3) - 1, a[1] + (edge >> 16 & 3) - 1, a[2] + (edge >> 18 & 3) - 1};
    REAL g[3] = {0, 0, 0}, n[3];
#if GRID
    REAL j[3][3] = {{0, 0, 0}, {0, 0, 0}, {0, 0, 0}};
#endif
#pragma unroll AXES_AT_ONCE
    for (uint axis = 0; axis < 3; axis++) { /* results enter at [2] and move down, so that no index varies */
        neighbours at_a = neighbours_of(in, s, a, axis), at_b = neighbours_of(in, s, b, axis);
        REAL ga = sample_difference(in, &at_a), gb = sample_difference(in, &at_b);
        g[0] = g[1], g[1] = g[2], g[2] = ga + (REAL)t * (gb - ga);
#if GRID == 1
        REAL ja = coordinate_difference(in, s, &at_a, axis, axis), jb = coordinate_difference(in, s, &at_b, axis, axis);
        const REAL along = ja + (REAL)t * (jb - ja); /* positions along an axis change in that coordinate alone */
#pragma unroll
        for (uint row = 0; row < 3; row++)
            j[0][row] = j[1][row], j[1][row] = j[2][row], j[2][row] = row == axis ? along : (REAL)0;
#elif GRID == 2
#pragma unroll
        for (uint row = 0; row < 3; row++) {
            REAL ja = coordinate_difference(in, s, &at_a, axis, row);
            REAL jb = coordinate_difference(in, s, &at_b, axis, row);
            j[0][row] = j[1][row], j[1][row] = j[2][row], j[2][row] = ja + (REAL)t * (jb - ja);
        }
#endif
    }
#if GRID
    gradient_map(j, g, n);
#else
    const float *m = s->space.normal_matrix;
#pragma unroll
    for (uint row = 0; row < 3; row++)
        n[row] = -(((REAL)m[3 * row] * g[0] + (REAL)m[3 * row + 1] * g[1]) + (REAL)m[3 * row + 2] * g[2]);
#endif
    REAL largest = largest_of(n);
    out[0] = out[1] = out[2] = 0;
    if (!(largest > 0)) return;
#pragma unroll
    for (uint row = 0; row < 3; row++) n[row] = DIVIDE(n[row], largest);
    REAL length = ROOT((n[0] * n[0] + n[1] * n[1]) + n[2] * n[2]);
#pragma unroll
    for (uint row = 0; row < 3; row++) out[row] = (float)DIVIDE(n[row], length);
}

#endif

#endif

#endif
