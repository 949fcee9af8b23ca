/*
 * tetracubes.h - isosurfaces of sampled volumes by marching tetrahedra, on OpenCL devices
 *
 * Method: Carneiro, Silva, Kaufman, "Tetra-Cubes: an algorithm to generate 3D isosurfaces based upon tetrahedra"
 * (SIBGRAPI 1996). Every cube of eight samples is split into five tetrahedra, mirrored on alternate cubes, so that
 * neighbours share their face diagonals; a sample is inside when it is >= the isovalue; every crossed edge becomes one
 * shared vertex. One kernel classifies and prefix-sums, a second emits. The result does not depend on the device, on
 * its tuning or on the engine: the scalar reference engine, plain C without OpenCL, makes the same bytes.
 *
 *     tc_context *context = NULL; tc_grid *grid = NULL; tc_mesh *mesh = NULL; tc_mesh_data data = {sizeof data};
 *     tc_context_options device; tc_context_options_init(&device);
 *     tc_grid_options volume;    tc_grid_options_init(&volume);
 *     tc_extract_options how;    tc_extract_options_init(&how);
 *     volume.dims[0] = nx; volume.dims[1] = ny; volume.dims[2] = nz; volume.type = TC_U8; volume.samples = samples;
 *     how.isovalue = 127.5;
 *     if (tc_context_create(&device, &context) || tc_grid_create(context, &volume, &grid) ||
 *         tc_extract(grid, &how, &mesh) || tc_mesh_get(mesh, &data))
 *         fprintf(stderr, "%s\n", tc_message());
 *     else
 *         use(data.positions, data.vertex_count, data.triangles, data.triangle_count);
 *     tc_mesh_destroy(mesh); tc_grid_destroy(grid); tc_context_destroy(context);
 *
 * Conventions. Every call that can fail returns a tc_status; tc_message() then says, for the calling thread, what was
 * wrong and what to do. Outputs are zeroed on failure, but for what tc_interpolate_field and tc_emit were to fill. The
 * library never prints, exits or aborts on data. A context, with its grids and meshes, is used by one thread at a time;
 * different contexts may be used at once by different threads.
 *
 * Results do not depend on the caller's floating-point environment (rounding, traps, flushing of subnormal numbers),
 * which is as it was when a call returns, flags included; callbacks run in it. Threads that drivers start within a call
 * start in the default one.
 *
 * A child made by fork() cannot use OpenCL when its parent has done so, as the drivers' threads are not in it: contexts
 * made there, and calls on the parent's, are TC_ERROR_DEVICE; the parent's objects can be destroyed. Fork first, or go
 * on by exec. The reference engine works in any process.
 *
 * Structs begin with struct_size, their size in the header that the caller was built with. A newer library takes and
 * fills only that much of a struct, and what is not there has its default; a size that no header up to the library's
 * can have given (0, one that is not a multiple of 8, one of a newer header) is TC_ERROR_ARGUMENT.
 *
 * Mistakes end in TC_ERROR_ARGUMENT, not in a crash, as far as they can be seen: NULL, and numbers, sizes, enumerators
 * and alignments that cannot be. What cannot be seen is the caller's to keep: pointers lead to as much memory as the
 * sizes beside them say, and nothing is used after it was destroyed. Destroy, release and init functions accept NULL.
 */
#ifndef TETRACUBES_H
#define TETRACUBES_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#if defined(__GNUC__)
#define TC_API __attribute__((visibility("default")))
#else
#define TC_API
#endif

/* --------------------------------------------------------------------------------------------------------- version */

/* Of this header, and of the library that it comes with: the only place where the version is written. */
#define TC_VERSION_MAJOR 0
#define TC_VERSION_MINOR 1
#define TC_VERSION_PATCH 0

/* One number that grows with the version, for #if TC_VERSION_NUMBER >= 10203, which is 1.2.3. */
#define TC_VERSION_NUMBER (TC_VERSION_MAJOR * 10000 + TC_VERSION_MINOR * 100 + TC_VERSION_PATCH)

/* "major.minor.patch" of the library that runs, which may be newer than the header. Never NULL; valid forever. */
TC_API const char *tc_version(void);

/* ---------------------------------------------------------------------------------------------------------- status */

typedef enum tc_status {
    TC_OK = 0,
    TC_ERROR_ARGUMENT,     /* an argument or option is not valid: the caller's mistake */
    TC_ERROR_DATA,         /* the grid cannot be contoured: one sample along an axis, sizes that overflow */
    TC_ERROR_DEVICE,       /* no OpenCL, no such device, or the device failed */
    TC_ERROR_MEMORY,       /* host or device memory ran out */
    TC_ERROR_LIMIT,        /* the mesh needs more than 2^32 - 1 vertices */
    TC_ERROR_CANCELLED,    /* the progress callback asked to stop */
    TC_ERROR_FILE,         /* a file of the cache, which the caller asked for, cannot be written */
    TC_ERROR_WRONG_RESULT, /* the device computes wrongly: found by check_device of tc_context_options */
} tc_status;

/* What the last failed call of this thread found wrong, in one or two sentences. Never NULL; valid until the thread's
 * next failing call. */
TC_API const char *tc_message(void);

/* --------------------------------------------------------------------------------------------------------- devices */

/* What matters here about one OpenCL device. */
typedef struct tc_device_info {
    size_t struct_size; /* set by the caller: sizeof(tc_device_info) */
    int platform_index; /* first number of the specification "platform:device" */
    int device_index;   /* second number */
    char platform[128];
    char name[128];
    char version[128]; /* CL_DEVICE_VERSION */
    char driver[128];  /* CL_DRIVER_VERSION */
    char type[16];     /* "cpu", "gpu", "accelerator" or "other" */
    uint32_t compute_units;
    uint64_t max_work_group_size;
    uint64_t global_memory_bytes;
    uint64_t max_buffer_bytes; /* grids with larger buffers are processed in slabs */
    uint64_t local_memory_bytes;
    int shares_host_memory; /* samples are used in place, not copied, unless the context has always_copy */
    int has_fp64;           /* without it, vertices of u32, i32 and f64 samples are made on the host */
    int rounds_division;    /* correctly rounded f32 division built in; else the kernels correct it */
} tc_device_info;

/* The number of devices of all platforms, in the order that indices of a specification count in. Fails with
 * TC_ERROR_DEVICE, and says what to install, where there is no OpenCL, no platform or no device. */
TC_API tc_status tc_device_count(int *count);

/* Fills *info for device index (0 <= index < count). */
TC_API tc_status tc_device_get(int index, tc_device_info *info);

/* --------------------------------------------------------------------------------------------------------- context */

typedef enum tc_engine {
    TC_ENGINE_OPENCL = 0,
    TC_ENGINE_REFERENCE = 1, /* scalar C on the calling thread; needs no OpenCL */
} tc_engine;

/* Called on the extracting thread now and then, first when kernels have been built; fraction runs from 0 to 1 within
 * one call of the library. Return nonzero to cancel: the call then returns TC_ERROR_CANCELLED, and everything can be
 * used again. */
typedef int (*tc_progress)(void *user, const char *stage, double fraction);

/* How a trial of kernels in a process of its own has ended. */
typedef enum tc_verdict {
    TC_VERDICT_NONE = 0,     /* there was none, as no process could be started: the kernels are used untried */
    TC_VERDICT_GOOD,         /* tc_trial_run returned TC_OK, and the process ended well */
    TC_VERDICT_WRONG_RESULT, /* it returned TC_ERROR_WRONG_RESULT */
    TC_VERDICT_REFUSED,   /* it returned another status: the driver does not build the kernels, or does not run them */
    TC_VERDICT_CRASHED,   /* the driver ended the process */
    TC_VERDICT_HUNG,      /* it did not end in time */
    TC_VERDICT_STOPPED,   /* somebody else ended the process, or memory ran out: the call fails, nothing is kept */
    TC_VERDICT_CANCELLED, /* the caller does not want to wait: the library's call returns TC_ERROR_CANCELLED */
} tc_verdict;

/* Runs tc_trial_run(job) in another process, with a limit of time, and tells how that ended; reason: room for a line,
 * which was set empty: tc_message() of that process, or its last words. job is a line of text. Called on the thread
 * that calls the library. */
typedef tc_verdict (*tc_trial)(void *user, const char *job, char *reason, size_t reason_bytes);

struct _cl_context;
struct _cl_command_queue;
struct _cl_event;
struct _cl_mem;

typedef struct tc_context_options {
    size_t struct_size; /* set by tc_context_options_init; a caller built against an older header still works */
    tc_engine engine;
    const char *device; /* an index, "platform:device", "cpu", "gpu" or part of a name; NULL: the environment's
                           TETRACUBES_DEVICE, else the first CPU or other device found */
    struct _cl_context *cl_context;     /* the caller's own, retained while the context lives; NULL: made here */
    struct _cl_command_queue *cl_queue; /* of cl_context, not out of order (TC_ERROR_ARGUMENT otherwise); needed where
                                           cl_context is given */
    uint64_t max_memory_bytes; /* bound on device buffers for one grid and its extraction, mesh and samples included;
                                  0: what the device allows. Less memory means smaller slabs, never other results */
    uint32_t work_items;  /* per work-group: 1, or a multiple of 32 up to 1024; 0: default. 1 has kernels of its own,
                             for CPUs, which compilers known to fail on them are not given: TC_ERROR_ARGUMENT. A
                             kernel that the device runs with fewer is built again for as many as it allows.
                             Never changes results */
    uint32_t work_groups; /* launched at once; 0: the device's default. Never changes results */
    uint32_t tile_bricks; /* at least so many bricks per tile of the scan; 0: default. Never changes results. These
                             three all 0: what tc_context_tuning_save kept for the device, if it did */
    uint32_t spin_limit;  /* polls of an unfinished tile before its sum is recomputed; 0: default; 1 also recomputes the
                             tile  before each, which tests that path. Never changes results */
    int division;         /* 0: best of the device; 1: built in; 2: through fp64; 3: in integers */
    tc_progress progress; /* NULL: none */
    void *progress_user;
    int always_copy;  /* nonzero: a device that shares the host's memory is treated like one with memory of its own:
                         samples are copied to it and the mesh from it. Slower; runs that path where there is no such
                         device. Never changes results */
    int check_device; /* nonzero: kernels are tried before tc_count or tc_extract first use them in this context: a
                         small volume goes through them and every byte is compared with the reference engine's. Where
                         one differs, the call returns TC_ERROR_WRONG_RESULT. Takes milliseconds for each kind of
                         kernels. tc_emit tries nothing itself */
    tc_trial trial;   /* called before a driver that is not known to be good first builds kernels of a kind: see below;
                         NULL: it builds them in this process at once */
    void *trial_user;
} tc_context_options;

typedef struct tc_context tc_context;

/* Defaults: OpenCL engine, default device, no bound on memory, no progress. */
TC_API void tc_context_options_init(tc_context_options *options);

/* Picks the device; kernels are built when the first extraction needs them, or taken from the cache: files in the
 * folder that the environment's TETRACUBES_CACHE_DIR names, else XDG_CACHE_HOME/tetracubes, else HOME/.cache/tetracubes
 * (empty TETRACUBES_CACHE_DIR: no cache). tc_context_destroy puts there what had to be built; files that are damaged or
 * cannot be written are done without, as are files and folders that are neither the user's nor root's, or that others
 * may write to: what is in them would run. The context keeps device buffers between extractions. Destroy its grids and
 * meshes before it. */
TC_API tc_status tc_context_create(const tc_context_options *options, tc_context **context);
TC_API void tc_context_destroy(tc_context *context);

/* Drivers that crash or hang take the process with them. So the library can have them tried before: with options.trial
 * set, opening a device and each kind of kernels (of grid, type, method, missing samples, normals) is tried once in a
 * process that the callback starts, unless driver and version are among those known to be good. The verdict is kept in
 * the cache, for device, driver, versions and kernels, beside the programs that the trial has built; later contexts,
 * of other processes too, find both. A verdict that is not good makes the library take its other text of the kernels
 * (one work-item per group, or groups of them), where work_items is 0 and that one passes; else the call fails with
 * TC_ERROR_DEVICE or TC_ERROR_WRONG_RESULT and says what was found. Kept verdicts count in contexts without a callback
 * too. The library itself starts no process. A caller's cl_context is tried on the device of tc_device_get that it has;
 * where it has another, a part of one, it is used untried. tc_emit that meets kernels which are not good fails; after
 * that count again.
 *
 * tc_trial_run does what the job says: it opens the device, builds the kernels, runs them on a small volume and
 * compares every byte with the reference engine. progress, which may be NULL, is told "run" when they are built. The
 * driver may crash or hang in it, so it belongs into a process without other work, with the same environment. The tool
 * does so by running itself. */
TC_API tc_status tc_trial_run(const char *job, tc_progress progress, void *progress_user);

/* The device of an OpenCL context; TC_ERROR_ARGUMENT for the reference engine, which has none. */
TC_API tc_status tc_context_device(const tc_context *context, tc_device_info *info);

/* How kernels are launched; fields as in tc_context_options. Never changes results. */
typedef struct tc_tuning {
    size_t struct_size; /* set by the caller: sizeof(tc_tuning) */
    uint32_t work_items, work_groups, tile_bricks;
} tc_tuning;

/* What the context launches with; TC_ERROR_ARGUMENT for the reference engine. */
TC_API tc_status tc_context_tuning(const tc_context *context, tc_tuning *tuning);

/* Keeps that in the cache folder, for this device and driver: later contexts whose options leave all three at 0 launch
 * so. TC_ERROR_FILE where that cannot be written. */
TC_API tc_status tc_context_tuning_save(const tc_context *context);

/* The context's OpenCL objects, not retained; NULL for the reference engine. */
TC_API struct _cl_context *tc_context_cl_context(const tc_context *context);
TC_API struct _cl_command_queue *tc_context_cl_queue(const tc_context *context);

/* Bytes of device buffers held at this moment and at most so far, samples and mesh included, also where they lie in
 * memory of the host that the device uses in place. */
TC_API uint64_t tc_context_device_bytes(const tc_context *context, uint64_t *peak);

/* ------------------------------------------------------------------------------------------------------------ grid */

typedef enum tc_type { TC_U8 = 0, TC_I8, TC_U16, TC_I16, TC_U32, TC_I32, TC_F32, TC_F64 } tc_type;

/* Bytes of one sample; 0 for a value that is no type. */
TC_API size_t tc_type_bytes(tc_type type);

/* "u8", "i8", ..., "f64"; NULL for a value that is no type. */
TC_API const char *tc_type_name(tc_type type);

typedef struct tc_grid_options {
    size_t struct_size;
    int64_t dims[3];        /* samples along x, y, z; each at least 2 */
    int64_t first_index[3]; /* index of the first sample, where a file's extents do not start at 0: the parity of cubes
                            and the index space of positions count from it. First and last index of 32 bits */
    tc_type type;           /* native byte order */
    const void *samples;    /* dims[0] * dims[1] * dims[2], x fastest, no padding, aligned to the type; borrowed until
                               tc_grid_destroy, not copied where the device shares the host's memory */
    double matrix[3][4];    /* index space to world: world[r] = m[r][0] i + m[r][1] j + m[r][2] k + m[r][3]. May mirror
                               (triangles keep their outward side); default: identity. Used as float32 */
    int has_nodata;         /* samples equal to nodata are missing, as are all that are not finite: a cube with a */
    double nodata;          /* missing corner is left out whole. Rounded to float where samples are f32, so that the
                               decimal number that stands for a sample equals it (-999.9, 0.1, 1e20); exact otherwise: a
                               number that no sample can have, 0.5 or -1 of u8, is equal to none. Not finite: none */
    struct _cl_mem *cl_samples; /* instead of samples: a buffer of the context's cl_context, retained until
                                   tc_grid_destroy; commands that write it come first in the context's queue, or are
                                   complete. Not for the reference engine */
    uint64_t cl_samples_offset; /* in samples, of the first one in that buffer */

    /* Rectilinear and curvilinear grids; borrowed as the samples are. With neither the grid is uniform. Coordinates are
     * finite and below 2^127 (TC_ERROR_DATA otherwise), those of samples that are missing, points only, may be
     * anything. Vertices lie at p0 + t (p1 - p0), and at p1 itself when t = 1. Triangles keep their outward side where
     * the sum of the Jacobians of all cubes, blanked ones left out, is negative; single cubes may be collapsed or
     * folded. */
    const float
        *axes[3];        /* rectilinear: dims[a] positions along each axis, rising or falling; in place of the matrix */
    const float *points; /* curvilinear: x, y, z of every sample, in place of the matrix */
    const uint8_t *blanked_samples; /* one per sample, nonzero: missing, as one that is not finite; NULL: none */
    const uint8_t *blanked_cells;   /* one per cube, (dims[0] - 1) (dims[1] - 1) (dims[2] - 1) of them, x fastest;
                                       nonzero: the cube is left out; NULL: none */

    /* Grids far from zero. Positions are float32, whose steps grow with the distance from 0 (half a metre at 4,600 km);
     * so positions, axes and points are taken relative to an origin in double precision, which tc_grid_origin tells and
     * tc_mesh_data carries. It is 0, 0, 0 unless the grid lies, along an axis, farther from 0 than 8 times its own size
     * and 512 times its smallest cell; then it is the middle of the grid, rounded. Coordinates in double precision are
     * borrowed during tc_grid_create only. */
    const double *axes_f64[3]; /* in place of axes */
    const double *points_f64;  /* in place of points */
    int has_origin;            /* nonzero: the origin is the one given here; several grids then share one */
    double origin[3];
} tc_grid_options;

typedef struct tc_grid tc_grid;

/* Defaults: no samples, identity matrix, first sample 0, 0, 0, no missing value. */
TC_API void tc_grid_options_init(tc_grid_options *options);

/* Checks the description and makes the samples available to the device. TC_ERROR_DATA for a grid of one sample along
 * an axis and for sizes that overflow. Samples may not change while the grid lives: it remembers what it has seen of
 * them, so that further isovalues leave most unread. */
TC_API tc_status tc_grid_create(tc_context *context, const tc_grid_options *options, tc_grid **grid);
TC_API void tc_grid_destroy(tc_grid *grid); /* waits for what is under way on it */

/* The point in world space that positions of the grid's meshes are relative to: world = origin + position, in double
 * precision. Of complexes too. */
TC_API tc_status tc_grid_origin(const tc_grid *grid, double origin[3]);

/* ------------------------------------------------------------------------------------------------------ extraction */

/* How cubes are cut. */
typedef enum tc_method {
    TC_METHOD_TETRA = 0,  /* five tetrahedra per cube */
    TC_METHOD_HYBRID = 1, /* structured grids: vertices on edges of cubes only, about 2.4 times fewer triangles; where
                             marching cubes are ambiguous the tetrahedra decide, so that topology is the same */
} tc_method;

typedef struct tc_extract_options {
    size_t struct_size;
    double isovalue; /* finite; inside means sample >= isovalue, exactly */
    int normals;     /* nonzero: a unit normal per vertex, the negated gradient: zero where that vanishes, or where
                            points do not span space */
    tc_method method;
} tc_extract_options;

/* What classification alone tells. */
typedef struct tc_counts {
    size_t struct_size;
    uint64_t vertex_count;
    uint64_t triangle_count;
    uint64_t active_cell_count; /* cubes, of complexes tetrahedra, that the surface passes through */
    uint64_t mesh_bytes;        /* of positions and triangles */
    double classify_ms;
} tc_counts;

/* Milliseconds of the last extraction into a mesh, by the host's clock. */
typedef struct tc_timings {
    double classify_ms; /* kernel 1 over all slabs, reading of totals included */
    double emit_ms;     /* allocation of the mesh, kernel 2 over all slabs */
    double readback_ms; /* copy to the host, as far as kernels do not run beside it; 0 where memory is shared */
    double total_ms;    /* first launch to mesh complete where the device left it */
} tc_timings;

/* The mesh in host memory. Triangles wind counter-clockwise seen from outside (the lower values) in world space. The
 * order of vertices and triangles is a function of grid and isovalue alone. */
typedef struct tc_mesh_data {
    size_t struct_size;
    uint64_t vertex_count;
    uint64_t triangle_count;
    uint64_t active_cell_count;
    const float *positions;    /* 3 per vertex, world space minus the origin below */
    const float *normals;      /* 3 per vertex, or NULL */
    const uint32_t *triangles; /* 3 vertex indices per triangle */
    uint32_t slab_count;       /* 1 where the grid was processed whole */
    uint32_t reserved;         /* 0 */
    tc_timings timings;
    double origin[3]; /* as tc_grid_origin tells it: 0, 0, 0 unless the grid lies far from 0 */
} tc_mesh_data;

typedef struct tc_mesh tc_mesh;

/* Defaults: isovalue 0, no normals. */
TC_API void tc_extract_options_init(tc_extract_options *options);

/* Classifies only: *counts (its struct_size set by the caller) receives the sizes of the mesh. */
TC_API tc_status tc_count(tc_grid *grid, const tc_extract_options *options, tc_counts *counts);

/* Extracts a surface. *mesh NULL: a new mesh is made, owned by the caller. Else *mesh, of the same context, is
 * overwritten and its memory used again. On failure a new mesh is not made, an old one is empty. */
TC_API tc_status tc_extract(tc_grid *grid, const tc_extract_options *options, tc_mesh **mesh);

/* Fills *data (its struct_size set by the caller). Pointers stay valid until the mesh is extracted into or destroyed.
 */
TC_API tc_status tc_mesh_get(tc_mesh *mesh, tc_mesh_data *data);
TC_API void tc_mesh_destroy(tc_mesh *mesh);

/* Another field on a grid's samples. */
typedef struct tc_field {
    size_t struct_size; /* set by the caller: sizeof(tc_field) */
    tc_type type;
    int components;     /* values per sample, next to each other */
    const void *values; /* as many tuples as the grid has samples */
} tc_field;

/* Carries a field onto the surface: out[vertex][component], a + t (b - a) in double with the t that placed the vertex,
 * a or b itself where t is 0 or 1, whatever the other is, in the order in which tc_extract makes vertices. out has room
 * for value_count floats, which must be what that takes (TC_ERROR_ARGUMENT otherwise). Runs on the calling thread,
 * whatever the engine; not for grids with cl_samples. */
TC_API tc_status tc_interpolate_field(tc_grid *grid, const tc_extract_options *options, const tc_field *field,
                                      float *out, uint64_t value_count);

/* ---------------------------------------------------------------------------------------------- unstructured grids */

/* Cells of any kind, in VTK's numbering of types and of the points in a cell. All arrays are borrowed during the call.
 */
typedef struct tc_cells {
    size_t struct_size; /* set by the caller: sizeof(tc_cells) */
    uint64_t point_count;
    const float *points; /* x, y, z each; at the corners of cells that are not left out finite and below 2^127 */
    uint64_t cell_count;
    const uint8_t *types;
    const int64_t
        *offsets; /* cell_count + 1: where in `connectivity` the points of a cell begin; the last: its length */
    const int64_t *connectivity;
    const uint8_t *blanked_points; /* nonzero: missing; cells that contain one are left out whole. NULL: none */
    const uint8_t *blanked_cells;  /* nonzero: left out; NULL: none */
    const double *points_f64;      /* in place of points: double precision */

    /* Polyhedra (type 42) are given by their faces; what `connectivity` has of them is not read. Cell c has the faces
     * cell_faces[c] to cell_faces[c + 1] - 1, none where it is of another type; face n has the points
     * face_connectivity[face_offsets[n]] to [face_offsets[n + 1] - 1], in their order around it, either way round. A
     * face between two polyhedra is listed for each. NULL where there are no polyhedra. */
    const int64_t *cell_faces;        /* cell_count + 1; the last: the number of faces */
    const int64_t *face_offsets;      /* a number per face and one more; the last: the length of face_connectivity */
    const int64_t *face_connectivity; /* points */

    int skip_unsupported; /* nonzero: cells that cannot be cut for their type, and polyhedra whose faces are not closed,
                             are left out instead of refused */
} tc_cells;

/* A conforming tetrahedral complex: tetrahedra of one cell follow each other, in the order of the cells. Where a cell's
 * volume is positive, v0 v1 v2 wind counter-clockwise seen from v3's other side: (v1 - v0) x (v2 - v0) . (v3 - v0) > 0
 * unless the cell is folded; where it is negative they have been turned over. */
typedef struct tc_tetrahedra {
    size_t struct_size; /* set by the caller: sizeof(tc_tetrahedra) */
    uint64_t tetrahedron_count;
    const uint32_t *tetrahedra; /* 4 points each */
    const uint32_t *cells;      /* of each tetrahedron: the cell it is part of */
    uint64_t flat_cell_count;   /* cells of fewer than three dimensions, skipped */
    uint64_t curved_cell_count; /* quadratic and higher cells, of which the corners were used */
    uint64_t blanked_cell_count;
    uint64_t inverted_cell_count; /* of negative volume, turned over */
    uint64_t folded_cell_count;   /* whose tetrahedra differ in sign; of polyhedra not where those of the smaller sign
                                     have less than 1e-5 of the volume, as rounding makes them of faces in one plane */
    uint64_t unsupported_cell_count; /* left out as tc_cells.skip_unsupported asks */
    uint64_t surplus_cell_count;     /* with more points than their type has, of which the first were taken */
} tc_tetrahedra;

/* Cuts cells into tetrahedra: the diagonal of every quadrilateral face goes through its smallest point number, and
 * faces of more corners are fans around it, so that neighbours agree whatever their types (Dompierre, Labbe, Vallet,
 * Camarero 1999). Tetrahedra, hexahedra, voxels, wedges, pyramids, pentagonal and hexagonal prisms, convex polyhedra,
 * and the quadratic kin of the former by their corners. TC_ERROR_DATA for points out of range, coordinates of a corner
 * that are not finite or 2^127 and beyond, cells with too few points, 3D types that are none of these, and polyhedra
 * whose faces are not closed; TC_ERROR_LIMIT for more than 2^32 - 1 points or tetrahedra. The complex, zeroed on
 * failure, is freed by tc_tetrahedra_release. */
TC_API tc_status tc_tetrahedralize(const tc_cells *cells, tc_tetrahedra *tetrahedra);

/* The same of a structured grid: five tetrahedra per cube, mirrored on alternate cubes, as the structured path does. Of
 * the options only sizes, parity (first), coordinates and what is missing matter. Points are the samples. */
TC_API tc_status tc_tetrahedralize_grid(const tc_grid_options *grid, tc_tetrahedra *tetrahedra);
TC_API void tc_tetrahedra_release(tc_tetrahedra *tetrahedra);

typedef struct tc_tetrahedra_grid_options {
    size_t struct_size; /* set by tc_tetrahedra_grid_options_init */
    uint64_t point_count;
    const float *points; /* x, y, z each, finite; borrowed until tc_grid_destroy, as the next three are */
    tc_type type;
    const void *samples; /* one per point; tetrahedra with a sample that is not finite are left out */
    uint64_t tetrahedron_count;
    const uint32_t *tetrahedra; /* 4 points each, ordered as in tc_tetrahedra */
    const double *points_f64; /* in place of points: double precision, borrowed during tc_tetrahedra_grid_create only */
    int has_origin;           /* as in tc_grid_options */
    double origin[3];
} tc_tetrahedra_grid_options;

TC_API void tc_tetrahedra_grid_options_init(tc_tetrahedra_grid_options *options);

/* A grid that tc_count and tc_extract take like a structured one, without normals, and by TC_METHOD_TETRA only; active
 * cells are tetrahedra. Vertices are numbered by the first tetrahedron that contains their edge, then by edge (01 02 03
 * 12 13 23); triangles follow their tetrahedra. Crossings go from the lower to the higher point number. A complex that
 * the device cannot hold whole is processed in slabs, runs of its tetrahedra, from the first surface on that does not
 * fit; the bytes are the same. TC_ERROR_MEMORY, with what would do, where not even 16 tetrahedra fit; TC_ERROR_LIMIT
 * for more than 2^32 - 1 points or tetrahedra; TC_ERROR_DEVICE for u32, i32 and f64 samples on a device without fp64.
 * A tetrahedron with a point that is not there is TC_ERROR_DATA, found when the tetrahedra are first read: by tc_count
 * or tc_extract. */
TC_API tc_status tc_tetrahedra_grid_create(tc_context *context, const tc_tetrahedra_grid_options *options,
                                           tc_grid **grid);

/* -------------------------------------------------------------------------------------------------- on the device */

/* Buffers of the context's cl_context that a mesh goes to: three floats per vertex, relative to tc_grid_origin, three
 * indices of 32 bits per triangle, as in tc_mesh_data. Buffers for nothing may be NULL. */
typedef struct tc_device_mesh {
    size_t struct_size; /* set by the caller: sizeof(tc_device_mesh) */
    struct _cl_mem *positions;
    struct _cl_mem *normals; /* where the options ask for normals */
    struct _cl_mem *triangles;
} tc_device_mesh;

/* Emits what tc_count has counted for the same grid and options, with no other call on the context's grids in between
 * (TC_ERROR_ARGUMENT otherwise, and for buffers that are too small): count, allocate, emit. Only enqueues; *done, the
 * caller's to release, is complete when the mesh is there; NULL: none is made. The one point where the host waits is in
 * tc_count, which reads the sizes. Needs a device that holds the grid and its mesh whole (TC_ERROR_MEMORY), and fp64
 * for u32, i32 and f64 samples (TC_ERROR_DEVICE). */
TC_API tc_status tc_emit(tc_grid *grid, const tc_extract_options *options, const tc_device_mesh *mesh,
                         struct _cl_event **done);

#ifdef __cplusplus
}
#endif

#endif
