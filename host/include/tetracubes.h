/*
 * tetracubes.h - isosurfaces of sampled volumes by marching tetrahedra, on OpenCL devices
 *
 * Method: Carneiro, Silva, Kaufman, "Tetra-Cubes: an algorithm to generate 3D isosurfaces based upon tetrahedra"
 * (SIBGRAPI 1996). Every cube of eight samples is split into five tetrahedra. The split is mirrored on alternate cubes,
 * so that neighbours share their face diagonals. A sample is inside when it is >= the isovalue. Every edge of a
 * tetrahedron between an inside and an outside sample has one vertex, which all triangles there share. The mesh does
 * not depend on the device, its tuning or the engine: the reference engine, scalar C without OpenCL, makes the same
 * bytes.
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
 * Sections: version, status, devices, context, grid, extraction, label maps, pieces of a grid, surfaces larger than
 * memory, other fields, interval volumes, unstructured grids, meshes that stay on the device, expert and test settings.
 *
 * What holds for all of it:
 *
 * Errors. Calls that can fail return a tc_status; tc_message() then says, for the calling thread, what was wrong and
 * what to do. Any of them may return TC_ERROR_ARGUMENT or TC_ERROR_MEMORY; those that use a context with OpenCL also
 * TC_ERROR_DEVICE; those that call a progress callback also TC_ERROR_CANCELLED. Further errors are named at the call.
 * On failure outputs are zero, except the arrays that tc_interpolate_field, tc_interpolate_interval_volume, tc_emit and
 * tc_count_piece fill, whose content is then undefined. The library never prints, exits or aborts on data.
 *
 * Mistakes of the caller end in TC_ERROR_ARGUMENT, not in a crash, where they can be seen: NULL, and numbers, sizes,
 * enumerators and alignments that cannot be. The caller sees to the rest: arrays have as many elements as the sizes
 * beside them say, and nothing is used after it was destroyed. Destroy, release and init functions accept NULL.
 *
 * Threads. A context, with its grids and meshes, is used by one thread at a time, which need not be the same one each
 * time. Different threads may use different contexts at once. Functions without a context, grid or mesh may be called
 * by any thread at any time.
 *
 * Ownership. What a create function, an extracting function or tc_tetrahedralize makes is the caller's to destroy or
 * release: grids, meshes and interval volumes before their context. Arrays and strings are read during the call only,
 * unless the field says that they are borrowed for longer.
 *
 * Structs begin with struct_size, the size of the struct in the header that the caller was built with: options have an
 * init function that sets it and the defaults; in other structs the caller sets it, and zeros all else that it does
 * not fill; in structs that callbacks get the library has set it. A newer library reads and fills only that much, and
 * takes defaults for what is not there. A size that no header up to the library's can have given (0, one that is not a
 * multiple of 8, one of a newer header) is TC_ERROR_ARGUMENT.
 *
 * Floating-point environment (rounding, traps, flushing of subnormal numbers): results do not depend on the caller's,
 * which is as it was when a call returns, flags included. Callbacks run in it. Threads that drivers start within a call
 * start in the default one.
 *
 * Processes. OpenCL does not survive fork(): the drivers' threads are not in the child. In a child of a process that
 * has used OpenCL, new contexts and calls on the parent's are TC_ERROR_DEVICE; the parent's objects can be destroyed.
 * Fork first, or go on by exec. The reference engine works in any process.
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

/* OpenCL's own types, so that this header needs none of its headers: cl_context is struct _cl_context *, cl_mem is
 * struct _cl_mem *, and so on. */
struct _cl_context;
struct _cl_command_queue;
struct _cl_event;
struct _cl_mem;

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
    TC_ERROR_DATA,         /* the grid cannot be contoured: one sample along an axis, more than 2^24 along one, sizes
                              that overflow, coordinates that are not finite, cells that cannot be cut */
    TC_ERROR_DEVICE,       /* no OpenCL, no such device, or the device failed */
    TC_ERROR_MEMORY,       /* host or device memory ran out */
    TC_ERROR_LIMIT,        /* more than 2^32 - 1 vertices, points or tetrahedra, or planes of samples too large for the
                              kernels */
    TC_ERROR_CANCELLED,    /* a callback asked to stop */
    TC_ERROR_FILE,         /* a file of the cache that the caller asked for cannot be written */
    TC_ERROR_WRONG_RESULT, /* the device computes wrongly: found by check_device, or by a trial in a child process */
} tc_status;

/* What the last failed call of this thread found wrong, in one or two sentences of English; "" before any. Never NULL;
 * valid until the thread's next failing call. */
TC_API const char *tc_message(void);

/* --------------------------------------------------------------------------------------------------------- devices */

/* What matters here about one OpenCL device. Texts end with a zero byte, cut to fit. */
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
    uint64_t max_work_group_size; /* work-items */
    uint64_t global_memory_bytes;
    uint64_t max_buffer_bytes; /* grids with larger buffers are processed in slabs */
    uint64_t local_memory_bytes;
    int shares_host_memory; /* samples are used in place, not copied, unless the context's always_copy is set */
    int has_fp64;           /* without it, vertices of u32, i32 and f64 samples are made on the host */
    int rounds_division;    /* its f32 division can be correctly rounded; else the kernels round it themselves */
} tc_device_info;

/* *count: the number of devices of all platforms. Indices count through the platforms in OpenCL's order, and through
 * the devices of each. TC_ERROR_DEVICE, with what to install, where there is no OpenCL, no platform or no device. */
TC_API tc_status tc_device_count(int *count);

/* Fills *info for device `index`, 0 <= index < count. */
TC_API tc_status tc_device_get(int index, tc_device_info *info);

/* --------------------------------------------------------------------------------------------------------- context */

typedef enum tc_engine {
    TC_ENGINE_OPENCL = 0,
    TC_ENGINE_REFERENCE = 1, /* scalar C on the calling thread; needs no OpenCL */
} tc_engine;

/* Tells how far a call of the library is. Called now and then on the thread that made that call, for the first time
 * when kernels have been built. stage: a word for what is being done ("classify", "emit", ...), valid during the
 * callback; fraction runs from 0 to 1 within one call of the library. Return nonzero to cancel: the call then returns
 * TC_ERROR_CANCELLED, and its context and grid can be used again. It must not use the context of the call itself. */
typedef int (*tc_progress)(void *user, const char *stage, double fraction);

struct tc_expert_options; /* at the end of this header */

typedef struct tc_context_options {
    size_t struct_size; /* set by tc_context_options_init */
    tc_engine engine;
    const char *device; /* an index, "platform:device", "cpu", "gpu", "gpu:1" (the second one) or part of a name; NULL:
                           the environment's TETRACUBES_DEVICE, else the first CPU or other device found */
    struct _cl_context *cl_context;     /* the caller's own, retained while the context lives; NULL: made here */
    struct _cl_command_queue *cl_queue; /* of cl_context, in order (TC_ERROR_ARGUMENT otherwise); needed where
                                           cl_context is given, not looked at elsewhere */
    uint64_t max_memory_bytes;          /* bound on device buffers for one grid and its extraction, mesh and samples
                                           included; 0: what the device allows. Less memory means smaller slabs, never
                                           other results */
    tc_progress progress;               /* NULL: none */
    void *progress_user;                /* handed to progress */
    int check_device; /* nonzero: kernels are tried before tc_count or tc_extract first use them in this context: a
                         small volume goes through them and every byte is compared with the reference engine's. Where
                         one differs, the call returns TC_ERROR_WRONG_RESULT. Takes milliseconds for each kind of
                         kernels. tc_emit tries nothing itself */
    const struct tc_expert_options *expert; /* NULL, as nearly always: defaults. Read by tc_context_create alone */
} tc_context_options;

/* A device, or the reference engine, with its kernels and the buffers that it keeps between extractions. */
typedef struct tc_context tc_context;

/* Defaults: OpenCL engine, default device, no bound on memory, no progress, device not checked. */
TC_API void tc_context_options_init(tc_context_options *options);

/* Opens a device. *context is the caller's to destroy, after its grids and meshes.
 *
 * Kernels are built when the first extraction needs them, or taken from the cache: files in the folder that the
 * environment's TETRACUBES_CACHE_DIR names, else XDG_CACHE_HOME/tetracubes, else HOME/.cache/tetracubes (empty
 * TETRACUBES_CACHE_DIR: no cache). What had to be built is put there by tc_context_destroy. What is in the cache runs
 * as machine code: files and folders are left alone that are neither the user's nor root's, or that others may write
 * to. Damaged files are ignored, and so is a cache that cannot be written. */
TC_API tc_status tc_context_create(const tc_context_options *options, tc_context **context);
TC_API void tc_context_destroy(tc_context *context);

/* Fills *info for the context's device. TC_ERROR_ARGUMENT for the reference engine, which has none. */
TC_API tc_status tc_context_device(const tc_context *context, tc_device_info *info);

/* The context's OpenCL objects, not retained; NULL for the reference engine, and for NULL. */
TC_API struct _cl_context *tc_context_cl_context(const tc_context *context);
TC_API struct _cl_command_queue *tc_context_cl_queue(const tc_context *context);

/* Milliseconds that kernels took so far until they were ready: built, or loaded from the cache, and tried where
 * check_device or child_trial ask for that. No timing of a result includes them; but a driver that puts compiling off
 * until kernels run, as PoCL does, is only told whole where check_device is set. 0 for NULL. */
TC_API double tc_context_build_ms(const tc_context *context);

/* Bytes of device buffers held at this moment; *peak, which may be NULL: at most so far. Samples and mesh are included,
 * also where they lie in memory of the host that the device uses in place. 0 for NULL. */
TC_API uint64_t tc_context_device_bytes(const tc_context *context, uint64_t *peak);

/* ------------------------------------------------------------------------------------------------------------ grid */

/* The type of a sample, or of a field's value: U unsigned, I signed, F floating-point, and the number of bits. */
typedef enum tc_type { TC_U8 = 0, TC_I8, TC_U16, TC_I16, TC_U32, TC_I32, TC_F32, TC_F64 } tc_type;

/* Bytes of one sample; 0 for a value that is no type. */
TC_API size_t tc_type_bytes(tc_type type);

/* "u8", "i8", ..., "f64", valid forever; NULL for a value that is no type. */
TC_API const char *tc_type_name(tc_type type);

/* A structured grid: uniform where only a matrix is given, else rectilinear (axes) or curvilinear (points). Cells are
 * the cubes between eight samples. All arrays are borrowed until tc_grid_destroy, except the coordinates in double
 * precision. */
typedef struct tc_grid_options {
    size_t struct_size;     /* set by tc_grid_options_init */
    int64_t dims[3];        /* samples along x, y, z; each from 2 to 2^24 */
    int64_t first_index[3]; /* index of the first sample, where a file's extents do not start at 0: the parity of
                               cubes (i + j + k even or odd), and index space, count from it. First and last index
                               fit in 32 bits */
    tc_type type;           /* of the samples, in native byte order */
    const void *samples;    /* dims[0] * dims[1] * dims[2], x fastest, no padding, aligned to the type. Not copied where
                               the device shares the host's memory */
    double matrix[3][4];    /* index space to world: world[r] = m[r][0] i + m[r][1] j + m[r][2] k + m[r][3]. May mirror
                               (triangles keep their outward side), not flatten. Default: identity. Used as float32 */
    int has_nodata; /* nonzero: samples equal to nodata are missing; those that are not finite always are. A cube
                       with a missing corner is left out whole */
    double nodata;  /* rounded to float where samples are f32, so that the decimal number that stands for a sample
                       equals it (-999.9, 0.1, 1e20). Exact for other types: a number that no sample can have (0.5
                       or -1 of u8, or one that is not finite) is equal to none */
    struct _cl_mem *cl_samples; /* instead of samples: a buffer of the context's cl_context, retained until
                                   tc_grid_destroy. Commands that write it come first in the context's queue, or are
                                   complete. Not for the reference engine */
    uint64_t cl_samples_offset; /* of the first sample in that buffer, in samples */

    /* Rectilinear and curvilinear grids. Coordinates are finite and below 2^127 (TC_ERROR_DATA otherwise); the points
     * of missing samples may be anything. A vertex lies at p0 + t (p1 - p0), and at p1 itself when t = 1. Triangles are
     * turned over where the sum of the Jacobians of all cubes that are not blanked is negative, so that they keep their
     * outward side; single cubes may be collapsed or folded. */
    const float *axes[3];           /* rectilinear, in place of the matrix: dims[a] positions along each axis a, rising
                                       or falling */
    const float *points;            /* curvilinear, in place of the matrix: x, y, z of every sample */
    const uint8_t *blanked_samples; /* one per sample, nonzero: missing, as one that is not finite; NULL: none */
    const uint8_t *blanked_cells;   /* one per cube, (dims[0] - 1) (dims[1] - 1) (dims[2] - 1) of them, x fastest;
                                       nonzero: the cube is left out; NULL: none */

    /* Grids far from zero. Positions are float32, whose steps grow with the distance from 0 (half a metre at 4,600 km).
     * So positions are made relative to an origin, subtracted in double precision; tc_grid_origin and tc_mesh_data tell
     * it. It is 0, 0, 0 unless the grid lies, along an axis, farther from 0 than 8 times its own size and 512 times its
     * smallest cell; then it is the middle of the grid, rounded. */
    const double *axes_f64[3]; /* in place of axes; borrowed during tc_grid_create only */
    const double *points_f64;  /* in place of points; likewise */
    int has_origin;            /* nonzero: the origin is the one given here; so several grids can share one */
    double origin[3];          /* in world space, finite */

    const struct tc_grid_options *whole; /* the grid that this one is a part of, so that surfaces of parts have the same
                                            bytes where they meet: float32 coordinates count from where they do in the
                                            whole. Read during tc_grid_create only: dims and first_index; axes or
                                            points, and what is blanked, of a rectilinear or curvilinear grid. Of a
                                            uniform grid the matrix is the part's, and the part lies within (else
                                            TC_ERROR_ARGUMENT). Samples may be NULL. NULL: a grid by itself */
    int64_t owned[2]; /* of a piece of the whole: of this grid's planes, counted from its own first one, those with
                         owned[0] <= z < owned[1] are its own, the others are halo; see "pieces of a grid". 0, 0: all */
} tc_grid_options;

/* Samples at points, ready for extraction: of a structured grid, or of tetrahedra. */
typedef struct tc_grid tc_grid;

/* Defaults: no samples, identity matrix, first sample 0, 0, 0, no missing value. */
TC_API void tc_grid_options_init(tc_grid_options *options);

/* Checks the description and makes the samples available to the device. *grid is the caller's to destroy, before the
 * context. Samples may not change while the grid lives: it remembers what it has seen of them, so that further
 * isovalues leave most unread. TC_ERROR_DATA for one sample along an axis, for sizes that overflow or are above the
 * limits, and for coordinates that are not finite; TC_ERROR_LIMIT where four planes of samples have more than 2^30 / 10
 * samples (OpenCL engine); closed surfaces and interval volumes have lower limits, and meet them when extracted. */
TC_API tc_status tc_grid_create(tc_context *context, const tc_grid_options *options, tc_grid **grid);
TC_API void tc_grid_destroy(tc_grid *grid); /* waits for what is under way on it */

/* The point in world space that positions of the grid's meshes are relative to: world = origin + position, in double
 * precision. For grids of tetrahedra too. */
TC_API tc_status tc_grid_origin(const tc_grid *grid, double origin[3]);

/* ------------------------------------------------------------------------------------------------------ extraction */

/* How cells become triangles. */
typedef enum tc_method {
    TC_METHOD_TETRA = 0,  /* five tetrahedra per cube, or the tetrahedra themselves */
    TC_METHOD_HYBRID = 1, /* vertices on edges of cubes only, about 2.4 times fewer triangles. Where marching cubes are
                             ambiguous the tetrahedra decide, so that the topology is theirs. Unstructured grids: see
                             `source` of tc_tetrahedra_grid_options */
    TC_METHOD_SNAP = 2,   /* structured grids: as tetra, but samples near the surface become vertices of it where the
                             topology stays: of smooth fields 0.22 to 0.37 of the triangles, of better shape; of noise,
                             and of samples in few steps, more */
} tc_method;

/* "tetra", "hybrid", "snap", valid forever; NULL for a value that is no method. */
TC_API const char *tc_method_name(tc_method method);

typedef struct tc_extract_options {
    size_t struct_size; /* set by tc_extract_options_init */
    double isovalue;    /* finite; inside means sample >= isovalue, exactly */
    int normals;        /* nonzero: a unit normal per vertex, the negated gradient; zero where that vanishes, or where
                           points do not span space. Structured grids only */
    tc_method method;
    double snap;  /* method snap: a sample moves along an edge to a crossing at most this part of the edge away; 0 to
                     0.5, rounded to float32 */
    int closed;   /* nonzero: the surface is closed where it ends, at the grid's border and beside missing cells: by the
                     inside part of the faces that one present cell has. Inside samples there are vertices: at the
                     sample, with its gradient as normal. The mesh then bounds the present part of {f >= isovalue}.
                     The border of a grid of tetrahedra is found by threads of the host, when a surface of it is
                     first closed; the grid keeps it */
    int reserved; /* 0, or TC_ERROR_ARGUMENT: room for what may come */
} tc_extract_options;

/* What classification alone tells. */
typedef struct tc_counts {
    size_t struct_size; /* set by the caller: sizeof(tc_counts) */
    uint64_t vertex_count;
    uint64_t triangle_count;
    uint64_t active_cell_count; /* cubes, or tetrahedra, that the surface passes through */
    uint64_t mesh_bytes;        /* of positions, triangles, and normals where the options ask for them */
    double classify_ms;
} tc_counts;

/* Milliseconds of the last extraction into a mesh, by the host's clock. A part of other structs, so it never grows. */
typedef struct tc_timings {
    double classify_ms; /* kernel 1 over all slabs, reading of totals included */
    double emit_ms;     /* allocation of the mesh, kernel 2 over all slabs */
    double readback_ms; /* copy to the host, as far as kernels do not run beside it; 0 where memory is shared */
    double total_ms;    /* first launch to mesh complete where the device left it */
} tc_timings;

/* The mesh in host memory. Triangles wind counter-clockwise seen from outside (the lower values) in world space. The
 * order of vertices and triangles depends on grid, isovalue and method alone. The arrays belong to the mesh. */
typedef struct tc_mesh_data {
    size_t struct_size; /* set by the caller: sizeof(tc_mesh_data) */
    uint64_t vertex_count;
    uint64_t triangle_count;
    uint64_t active_cell_count; /* as in tc_counts */
    const float *positions;     /* 3 per vertex: world space minus the origin below */
    const float *normals;       /* 3 per vertex; NULL where the options did not ask for them */
    const uint32_t *triangles;  /* 3 vertex indices per triangle, from 0 */
    uint32_t slab_count;        /* parts in which the grid was processed; 1: whole */
    uint32_t reserved;          /* 0 */
    tc_timings timings;
    double origin[3];                /* as tc_grid_origin tells it: 0, 0, 0 unless the grid lies far from 0 */
    const uint32_t *boundary_labels; /* of label maps: 2 per triangle, see tc_extract_labels; else NULL */
} tc_mesh_data;

typedef struct tc_mesh tc_mesh;

/* Defaults: isovalue 0, no normals, TC_METHOD_TETRA, snap 0.5, not closed. */
TC_API void tc_extract_options_init(tc_extract_options *options);

/* Classifies only: *counts receives the sizes of the mesh that the same options would make. */
TC_API tc_status tc_count(tc_grid *grid, const tc_extract_options *options, tc_counts *counts);

/* Extracts a surface. *mesh NULL: a new mesh is made, the caller's to destroy before the context. Else *mesh, of the
 * same context, is overwritten and its memory used again. On failure a new mesh is not made, an old one is empty.
 * TC_ERROR_LIMIT for more than 2^32 - 1 vertices, and where four planes of samples are too large for the kernels of
 * closed surfaces. */
TC_API tc_status tc_extract(tc_grid *grid, const tc_extract_options *options, tc_mesh **mesh);

/* Fills *data. Its pointers stay valid until the mesh is extracted into again or destroyed. */
TC_API tc_status tc_mesh_get(tc_mesh *mesh, tc_mesh_data *data);

/* The context keeps the memory for its next mesh, unless it has max_memory_bytes; the system takes it where it is short
 * of any (MADV_FREE). */
TC_API void tc_mesh_destroy(tc_mesh *mesh);

/* ------------------------------------------------------------------------------------------------------ label maps */

/* Surfaces of a segmentation, whose samples are labels: integers, of which 0 and negative ones are background. */
typedef struct tc_labels_options {
    size_t struct_size;     /* set by tc_labels_options_init */
    const uint32_t *labels; /* those that are wanted, none of them 0, in any order: others count as background. NULL,
                               with a count of 0: all */
    uint64_t label_count;
    uint32_t smoothing; /* sweeps of smoothing, at most 1000; 0 leaves stairs. Uniform grids only */
    int closed; /* nonzero: as if a layer of background lay around the grid, so that surfaces end half a cell beyond its
                   border (those of tc_extract end on it); else they have borders there */
} tc_labels_options;

/* Defaults: all labels, 8 sweeps, not closed. */
TC_API void tc_labels_options_init(tc_labels_options *options);

/* Extracts the surfaces between labels, and between labels and background, as one mesh in which neighbours share their
 * triangles. The grid is structured, of integers in the host's memory, and whole; missing samples are background.
 *
 * Where the corners of a tetrahedron have two labels, the surface between them is the one of an isovalue half way. With
 * three, vertices on its faces are added; with four, one in the middle: there the surfaces of several labels meet. So
 * the triangles that have one label on a side are the surface that this label alone would give, up to vertices more:
 * a manifold, with the same Euler characteristic.
 *
 * boundary_labels of tc_mesh_data has two labels per triangle: the first is that of the inner side, which is seen
 * clockwise, and the lower one; the background always comes second (as vtkSurfaceNets3D has it). Vertices follow each
 * other by bricks, rows, types and x as those of tc_extract do, and so do triangles; if there is one label, the mesh
 * without smoothing is that of tc_extract of samples 0 and 1 at 0.5, to the byte.
 *
 * Smoothing moves every vertex three quarters of the way to the mean of its neighbours, `smoothing` times, but no
 * farther from where it was made than 0.45 cells along each axis. Where surfaces meet, and at borders, only neighbours
 * there count (after Gibson, "Constrained elastic surface nets", 1998; Frisken, "SurfaceNets for multi-label
 * segmentations", 2022). It runs on threads of the host, whose number changes nothing. The context keeps the memory for
 * that, about as much as the mesh takes, which the system may take back. There are no normals, and tc_interpolate_field
 * does not know these vertices.
 *
 * Kernels make the surfaces of uniform grids; of others both engines do it on the host. *mesh as in tc_extract; active
 * cells are cubes with more than one label. TC_ERROR_ARGUMENT for other grids; TC_ERROR_LIMIT for more than 2^32 - 1
 * vertices. */
TC_API tc_status tc_extract_labels(tc_grid *grid, const tc_labels_options *options, tc_mesh **mesh);

/* ------------------------------------------------------------------------------------------------ pieces of a grid */

/* A surface in pieces, by processes or one after the other, whose meshes follow each other to the byte as the mesh of
 * the whole: for volumes larger than memory, and for codes whose ranks have parts of a grid each.
 *
 * The order of vertices and triangles is by bricks, and bricks follow each other by layers of four planes. So a piece
 * that owns whole layers has consecutive vertices and triangles of the whole mesh. It is a tc_grid with `whole` and
 * `owned` set: both begin at a multiple of 4 planes from the whole's first, and end at one or with the whole. Beside
 * the planes that it owns the grid has, but at the ends of the whole, a halo of at least 4 planes before and 2 after;
 * for TC_METHOD_SNAP 8 on either side. tc_count, tc_extract and tc_interpolate_field give what the piece owns.
 *
 * Cells between two pieces use vertices of the later one. Their numbers follow from its seam: how many of its vertices
 * lie before each brick of its first layer, tc_seam_size numbers, 4 bytes for 64 x 8 samples of a plane. So:
 * tc_count_piece of all pieces; each one's seam goes to the piece before; sums of counts are the base of each;
 * tc_extract_piece. In a piece's triangles, indices below its vertex_count are its own vertices, and vertex_count + n
 * is vertex n of the next piece. In the whole mesh all of them are larger by the number of vertices of the pieces
 * before. */

/* The numbers in a seam: bricks in a layer of the grid. */
TC_API uint64_t tc_seam_size(const tc_grid *grid);

/* As tc_count; fills seam, which has room for seam_size numbers (TC_ERROR_ARGUMENT where that is not tc_seam_size).
 * Structured grids only. */
TC_API tc_status tc_count_piece(tc_grid *grid, const tc_extract_options *options, tc_counts *counts, uint32_t *seam,
                                uint64_t seam_size);

/* As tc_extract. next_seam: of the next piece, by the same options; NULL with 0 where the whole ends with this one.
 * TC_ERROR_LIMIT also where vertices of the next piece have no number of 32 bits beside those of this one. */
TC_API tc_status tc_extract_piece(tc_grid *grid, const tc_extract_options *options, const uint32_t *next_seam,
                                  uint64_t seam_size, tc_mesh **mesh);

/* ------------------------------------------------------------------------------------- surfaces larger than memory */

/* A stream: samples come window by window of planes, and meshes go piece by piece; together the pieces are, to the
 * byte, what tc_extract makes of the whole. It takes two passes: all is counted, then emitted, and windows that no
 * surface passes through are not asked for again. A window that holds the whole grid is asked for once. */

/* Planes of samples of a stream's grid, x fastest. */
typedef struct tc_planes {
    size_t struct_size;       /* set by the library */
    int64_t first, count;     /* planes first to first + count - 1, from 0 at the whole's first, whatever first_index */
    void *samples;            /* aligned to the type */
    uint8_t *blanked_samples; /* one per sample, as in tc_grid_options; NULL where the grid has none */
    uint8_t *blanked_cells;   /* planes first to first + count - 1 of cells, less where the whole ends; likewise */
} tc_planes;

/* Fills the arrays, or sets them to memory of its own, which stays as it is until the next call or the end of the
 * stream. Within a pass no window begins or ends before the one before it, except that parts of the window asked for
 * last may be asked for again, where a mesh is too large. Nonzero ends the stream. */
typedef int (*tc_read_planes)(void *user, tc_planes *planes);

/* Called between the passes, once for each surface in their order: its counts. Nonzero ends the stream. */
typedef int (*tc_take_counts)(void *user, size_t surface, const tc_counts *counts);

/* A piece of a mesh. */
typedef struct tc_mesh_piece {
    size_t struct_size;                    /* set by the library */
    size_t surface;                        /* index of the surface */
    uint64_t first_vertex, first_triangle; /* in the whole mesh */
    const tc_mesh_data *mesh; /* valid during the call; add first_vertex to the indices of its triangles, of which those
                                 from mesh->vertex_count on are vertices of the next piece */
    tc_grid *grid;            /* of the piece, for tc_interpolate_field and tc_grid_origin */
    int64_t first_plane, plane_count; /* those that the grid has, from 0 at the whole's first */
} tc_mesh_piece;

/* Takes the next piece: of each surface in the order of the mesh, those without vertices and triangles left out.
 * Nonzero ends the stream. */
typedef int (*tc_take_piece)(void *user, const tc_mesh_piece *piece);

typedef struct tc_stream_options {
    size_t struct_size;          /* set by tc_stream_options_init */
    const tc_grid_options *grid; /* the whole. Its samples are not looked at, nor arrays of blanked samples or cells:
                                    not NULL says that planes have them. But of a curvilinear grid all of these, and
                                    points, have to be in memory, or mapped: which way round it is follows from them */
    const tc_extract_options *surfaces; /* one for each surface */
    size_t surface_count;
    uint64_t max_memory_bytes; /* host memory for a window of samples and a piece of a mesh; 0: 256 MiB. At least that
                                  of a few planes, and of the mesh of one layer of bricks, is taken */
    tc_read_planes read;
    tc_take_counts counted; /* NULL: none */
    tc_take_piece take;     /* NULL: the stream ends when all is counted */
    void *user;             /* handed to these three, which run on the thread of the call */
    int64_t owned[2];       /* only the pieces of the whole's planes owned[0] <= z < owned[1], multiples of 4 or its
                               ends: numbers then count from 0 there, and the last triangles may use vertices of the
                               next piece, as in tc_extract_piece. 0, 0: all */
} tc_stream_options;

/* Defaults: nothing given. */
TC_API void tc_stream_options_init(tc_stream_options *options);

/* Runs a stream on a context, with either engine. TC_ERROR_CANCELLED where a callback ends it; errors as of
 * tc_grid_create and tc_extract, except that a whole mesh may have more than 2^32 - 1 vertices: a piece may not. */
TC_API tc_status tc_stream(tc_context *context, const tc_stream_options *options);

/* ---------------------------------------------------------------------------------------------------- other fields */

/* Another field on the points of a grid, beside the samples that are contoured: pressure on a surface of density. */
typedef struct tc_field {
    size_t struct_size; /* set by the caller: sizeof(tc_field) */
    tc_type type;       /* of the values */
    int components;     /* values per point, next to each other; at least 1 */
    const void *values; /* components per point, points in the order of the grid's samples; aligned to the type */
} tc_field;

/* Interpolates the field onto the vertices of the surface that tc_extract makes of the same grid and options:
 * values[vertex][component] = a + t (b - a), in double precision, then rounded. a and b are the field at the two points
 * between which the vertex lies, t is what placed the vertex; a or b itself where t is 0 or 1, whatever the other is.
 * value_count: the floats that values has room for, which has to be vertices times components (TC_ERROR_ARGUMENT
 * otherwise). Fastest after tc_extract or tc_count of the same grid and surface, whose results it uses; else the
 * surface is counted first. Runs on threads of the host; not for grids with cl_samples. */
TC_API tc_status tc_interpolate_field(tc_grid *grid, const tc_extract_options *options, const tc_field *field,
                                      float *values, uint64_t value_count);

/* ------------------------------------------------------------------------------------------------ interval volumes */

/* An interval volume is the part of a grid with low <= f < high, as tetrahedra (Fujishiro, Maeda, Sato, "Interval
 * volume: a solid fitting technique for volumetric data display and analysis", 1995). Every sample is below, within or
 * above, so a tetrahedron of the grid has 81 cases. Vertices are the samples within, and the crossings of low and of
 * high, which are the vertices of these two surfaces as tc_extract makes them, to the bit and in their order. What is
 * within in a tetrahedron is a convex polyhedron. It is cut by cones from its first vertex over the faces without it,
 * and faces likewise, in one order of all vertices: samples by number; then crossings of low, then those of high, by
 * the lower and the higher sample of their edge. So neighbours agree on every face, and no points are added. */
typedef struct tc_interval_volume_options {
    size_t struct_size; /* set by tc_interval_volume_options_init */
    double low, high;   /* low < high; -INFINITY or INFINITY, not both: there is no such bound */
} tc_interval_volume_options;

/* The sizes of an interval volume. Vertices are in three blocks: samples, crossings of low, crossings of high. */
typedef struct tc_interval_volume_counts {
    size_t struct_size;                           /* set by the caller: sizeof(tc_interval_volume_counts) */
    uint64_t sample_count, low_count, high_count; /* vertices in each block */
    uint64_t tetrahedron_count;
    uint64_t interval_bytes; /* of positions and tetrahedra */
    double classify_ms;
} tc_interval_volume_counts;

/* An interval volume in host memory. The arrays belong to the tc_interval_volume. */
typedef struct tc_interval_volume_data {
    size_t struct_size;    /* set by the caller: sizeof(tc_interval_volume_data) */
    uint64_t vertex_count; /* sum of the three blocks */
    uint64_t sample_count, low_count, high_count;
    uint64_t tetrahedron_count;
    const float *positions;     /* 3 per vertex: world space minus the origin below */
    const uint32_t *tetrahedra; /* 4 vertex indices each, v0 v1 v2 v3, so that (v1 - v0) x (v2 - v0) . (v3 - v0) > 0
                                   where the grid's own tetrahedra have that */
    uint32_t slab_count;        /* parts in which the grid was processed; 1: whole */
    uint32_t reserved;          /* 0 */
    tc_timings timings;
    double origin[3]; /* as tc_grid_origin tells it */
} tc_interval_volume_data;

typedef struct tc_interval_volume tc_interval_volume;

/* Defaults: no bounds, which is not enough: set low, high or both. */
TC_API void tc_interval_volume_options_init(tc_interval_volume_options *options);

/* Counts only. Errors as of tc_extract_interval_volume. */
TC_API tc_status tc_count_interval_volume(tc_grid *grid, const tc_interval_volume_options *options,
                                          tc_interval_volume_counts *counts);

/* Makes an interval volume, of structured grids and of grids of tetrahedra. *interval NULL: a new one is made, the
 * caller's to destroy before the context. Else *interval, of the same context, is overwritten and its memory used
 * again. On failure a new one is not made, an old one is empty.
 *
 * The order depends on grid and bounds alone. Structured grids: samples and tetrahedra by bricks, then rows, then x, as
 * vertices and triangles of surfaces; tetrahedra of a cube by its five, then by case. Grids of tetrahedra: samples by
 * point number, of points that a tetrahedron without missing samples has; tetrahedra by that which they are a part of.
 *
 * TC_ERROR_MEMORY, with the bytes that it takes, where the host has not so much: tc_count_interval_volume tells them
 * before. TC_ERROR_LIMIT for more than 2^32 - 1 vertices, and where eight planes of samples are too large for the
 * kernels. TC_ERROR_ARGUMENT for pieces of a grid. TC_ERROR_DEVICE under the OpenCL engine for u32, i32 and f64 samples
 * on a device without fp64: use the reference engine. */
TC_API tc_status tc_extract_interval_volume(tc_grid *grid, const tc_interval_volume_options *options,
                                            tc_interval_volume **interval);

/* Fills *data. Its pointers stay valid until the interval volume is made anew or destroyed. */
TC_API tc_status tc_interval_volume_get(const tc_interval_volume *interval, tc_interval_volume_data *data);

/* As tc_mesh_destroy. */
TC_API void tc_interval_volume_destroy(tc_interval_volume *interval);

/* Another field at the vertices of the interval volume that tc_extract_interval_volume makes of the same grid and
 * options: at samples its own value, rounded to float32; on the two surfaces as tc_interpolate_field. value_count: the
 * floats that values has room for, which has to be vertices times components (TC_ERROR_ARGUMENT otherwise). Not for
 * grids with cl_samples. */
TC_API tc_status tc_interpolate_interval_volume(tc_grid *grid, const tc_interval_volume_options *options,
                                                const tc_field *field, float *values, uint64_t value_count);

/* ---------------------------------------------------------------------------------------------- unstructured grids */

/* An unstructured grid is extracted from in two steps: tc_tetrahedralize cuts its cells into tetrahedra, and
 * tc_tetrahedra_grid_create makes a tc_grid of these and of samples at their points. */

/* Cells of any kind, in VTK's numbering of types and of the points in a cell. All arrays are read during the call
 * only. */
typedef struct tc_cells {
    size_t struct_size; /* set by the caller: sizeof(tc_cells) */
    uint64_t point_count;
    const float *points; /* x, y, z each; finite and below 2^127 at the corners of cells that are not left out */
    uint64_t cell_count;
    const uint8_t *types;          /* one per cell, as VTK numbers them: 10 tetrahedron, 12 hexahedron, ... */
    const int64_t *offsets;        /* cell_count + 1: where the points of each cell begin in connectivity; the last is
                                      its length */
    const int64_t *connectivity;   /* point numbers, from 0 */
    const uint8_t *blanked_points; /* one per point, nonzero: missing; cells that have one are left out. NULL: none */
    const uint8_t *blanked_cells;  /* one per cell, nonzero: left out; NULL: none */
    const double *points_f64;      /* in place of points: double precision */

    /* Polyhedra (type 42) are given by their faces; what connectivity has of them is not read. Cell c has the faces
     * cell_faces[c] to cell_faces[c + 1] - 1, none where it is of another type. Face n has the points
     * face_connectivity[face_offsets[n]] to face_connectivity[face_offsets[n + 1] - 1], in their order around it,
     * either way round. A face between two polyhedra is listed for each. All NULL where there are no polyhedra. */
    const int64_t *cell_faces;        /* cell_count + 1; the last is the number of faces */
    const int64_t *face_offsets;      /* one per face and one more; the last is the length of face_connectivity */
    const int64_t *face_connectivity; /* point numbers, from 0 */

    int skip_unsupported; /* nonzero: cells whose type cannot be cut, and polyhedra whose faces are not closed, are left
                             out instead of refused */
} tc_cells;

/* Tetrahedra that fit together: a conforming complex. Those of one cell follow each other, in the order of the cells.
 * The points v0 v1 v2 v3 of each are ordered so that (v1 - v0) x (v2 - v0) . (v3 - v0) > 0, unless the cell is folded;
 * those of a cell of negative volume have been turned over for that. The arrays belong to the struct, and are freed by
 * tc_tetrahedra_release. */
typedef struct tc_tetrahedra {
    size_t struct_size; /* set by the caller: sizeof(tc_tetrahedra) */
    uint64_t tetrahedron_count;
    const uint32_t *tetrahedra;   /* 4 point numbers each */
    const uint32_t *cells;        /* one per tetrahedron: the cell that it is part of */
    uint64_t flat_cell_count;     /* cells of fewer than three dimensions, left out */
    uint64_t curved_cell_count;   /* quadratic and higher cells, of which the corners were used */
    uint64_t blanked_cell_count;  /* left out as blanked, or for a missing point */
    uint64_t inverted_cell_count; /* of negative volume, turned over */
    uint64_t folded_cell_count;   /* whose tetrahedra differ in sign. Of polyhedra not where those of the smaller sign
                                     have less than 1e-5 of the volume: rounding makes such of faces in one plane */
    uint64_t unsupported_cell_count; /* left out as tc_cells.skip_unsupported asks */
    uint64_t surplus_cell_count;     /* with more points than their type has, of which the first were taken */
} tc_tetrahedra;

/* Cuts cells into tetrahedra. The diagonal of every quadrilateral face goes through its smallest point number, and
 * faces of more corners are fans around it, so that neighbours agree whatever their types (Dompierre, Labbe, Vallet,
 * Camarero, "How to subdivide pyramids, prisms and hexahedra into tetrahedra", 1999). Takes tetrahedra, hexahedra,
 * voxels, wedges, pyramids, pentagonal and hexagonal prisms and convex polyhedra; quadratic cells by their corners.
 *
 * *tetrahedra is the caller's to release. Needs no context; runs on several threads, which have ended when it returns.
 * TC_ERROR_DATA for points out of range, coordinates of a corner that are not finite or 2^127 and beyond, cells with
 * too few points, three-dimensional types that are none of these, and polyhedra whose faces are not closed;
 * TC_ERROR_LIMIT for more than 2^32 - 1 points or tetrahedra. */
TC_API tc_status tc_tetrahedralize(const tc_cells *cells, tc_tetrahedra *tetrahedra);

/* The same of a structured grid: five tetrahedra per cube, as tc_extract cuts it. Of the options only dims,
 * first_index, coordinates and what is missing matter; samples are needed, cl_samples will not do. The points of the
 * tetrahedra are the samples. Errors as of tc_grid_create, and TC_ERROR_LIMIT for more than 2^32 - 1 samples or
 * tetrahedra. */
TC_API tc_status tc_tetrahedralize_grid(const tc_grid_options *grid, tc_tetrahedra *tetrahedra);

/* Frees the arrays and zeroes all but struct_size. */
TC_API void tc_tetrahedra_release(tc_tetrahedra *tetrahedra);

/* Samples at the points of tetrahedra. All arrays are borrowed until tc_grid_destroy, except points_f64. */
typedef struct tc_tetrahedra_grid_options {
    size_t struct_size; /* set by tc_tetrahedra_grid_options_init */
    uint64_t point_count;
    const float *points; /* x, y, z each, finite */
    tc_type type;        /* of the samples */
    const void *samples; /* one per point, aligned to the type; tetrahedra with a sample that is not finite are left
                            out */
    uint64_t tetrahedron_count;
    const uint32_t *tetrahedra; /* 4 point numbers each, ordered as in tc_tetrahedra */
    const double *points_f64;   /* in place of points: double precision, borrowed during the call only */
    int has_origin;             /* as in tc_grid_options */
    double origin[3];

    /* For TC_METHOD_HYBRID, both NULL otherwise: the cells that tc_tetrahedralize has cut, of which only cell_count,
     * types, offsets and connectivity matter, and `cells` of the tc_tetrahedra. The struct itself is read during the
     * call only. */
    const tc_cells *source;
    const uint32_t *cells;
} tc_tetrahedra_grid_options;

/* Defaults: no points, no tetrahedra. */
TC_API void tc_tetrahedra_grid_options_init(tc_tetrahedra_grid_options *options);

/* Makes a grid of tetrahedra, which tc_count, tc_extract and tc_interpolate_field take like a structured one: by
 * TC_METHOD_TETRA, or TC_METHOD_HYBRID where the cells are given, and without normals (TC_ERROR_ARGUMENT otherwise).
 * *grid is the caller's to destroy, before the context.
 *
 * TC_METHOD_HYBRID keeps cells whole: their vertices lie on their edges, and on the diagonals of faces with five or six
 * corners, but not on those of quadrilaterals. It takes all cells but polyhedra (TC_ERROR_DATA). Cells with a sample
 * that is not finite are left out whole; active cells are cells. Vertices are numbered by the first cell that contains
 * their edge, then by the corners of the edge, the lower first, as VTK numbers those of the shape (a wedge's with 1 and
 * 2, 4 and 5 exchanged).
 *
 * With TC_METHOD_TETRA active cells are tetrahedra. Vertices are numbered by the first tetrahedron that contains their
 * edge, then by edge (01 02 03 12 13 23); triangles follow their tetrahedra. Vertices go from the lower to the higher
 * point number. Where the device cannot hold all tetrahedra and their surface, they are processed in slabs, runs of
 * tetrahedra; the bytes are the same.
 *
 * Cells are those of the tetrahedra, or TC_ERROR_DATA: the reference engine compares all of them, kernels at least
 * those that the surface passes through. They read the arrays of the source where they are, if the device works in the
 * host's memory and `cells` rises and has every solid cell; otherwise, and in slabs, the host gathers the cells at
 * first, which takes time and up to 49 bytes per cell.
 *
 * TC_ERROR_LIMIT for more than 2^32 - 1 points or tetrahedra; TC_ERROR_DEVICE for u32, i32 and f64 samples on a device
 * without fp64. Found when tetrahedra are first read, by tc_count or tc_extract: TC_ERROR_DATA for a point number out
 * of range; TC_ERROR_MEMORY, with how much would do, where not even 16 tetrahedra, or 8 cells, fit. */
TC_API tc_status tc_tetrahedra_grid_create(tc_context *context, const tc_tetrahedra_grid_options *options,
                                           tc_grid **grid);

/* ----------------------------------------------------------------------------------- meshes that stay on the device */

/* Buffers of the context's cl_context that a mesh goes to, made by the caller in the sizes that tc_count tells. Buffers
 * for nothing may be NULL. */
typedef struct tc_device_mesh {
    size_t struct_size;        /* set by the caller: sizeof(tc_device_mesh) */
    struct _cl_mem *positions; /* 3 floats per vertex, relative to tc_grid_origin */
    struct _cl_mem *normals;   /* 3 floats per vertex, where the options ask for normals; not looked at elsewhere */
    struct _cl_mem *triangles; /* 3 vertex indices of 32 bits per triangle */
} tc_device_mesh;

/* Emits what tc_count has counted: count, allocate, emit. Grid and options are those of tc_count, with no other call on
 * the context's grids in between; otherwise, and for buffers that are too small, TC_ERROR_ARGUMENT.
 *
 * Only enqueues, in the context's queue. *done, the caller's to release, is complete when the mesh is there; done NULL:
 * no event is made. The only point where the host waits is in tc_count, which reads the sizes. For structured grids of
 * the OpenCL engine. Needs a device that holds the grid and its mesh whole (TC_ERROR_MEMORY), and fp64 for u32, i32 and
 * f64 samples (TC_ERROR_DEVICE). TC_ERROR_LIMIT for more than 2^32 - 1 vertices or triangles. */
TC_API tc_status tc_emit(tc_grid *grid, const tc_extract_options *options, const tc_device_mesh *mesh,
                         struct _cl_event **done);

/* ---------------------------------------------------------------------------------------- expert and test settings */

/* Nothing from here on is needed to extract surfaces, and nothing changes a mesh: these settings change the time that
 * it takes, run paths that the device at hand would not take by itself, or guard against drivers that crash. */

/* How kernels divide float32 numbers with correct rounding: the quotient is the same by each. */
typedef enum tc_division {
    TC_DIVISION_DEFAULT = 0,  /* the first of those below that the device has */
    TC_DIVISION_BUILT_IN = 1, /* the device's own, where rounds_division of tc_device_info */
    TC_DIVISION_FP64 = 2,     /* in double precision, where has_fp64 */
    TC_DIVISION_INTEGER = 3,  /* in integers, on any device */
} tc_division;

/* How a trial of kernels in a child process has ended. */
typedef enum tc_verdict {
    TC_VERDICT_NONE = 0,     /* there was none, as no process could be started: the kernels are used untried */
    TC_VERDICT_GOOD,         /* tc_trial_run returned TC_OK, and the process ended well */
    TC_VERDICT_WRONG_RESULT, /* it returned TC_ERROR_WRONG_RESULT */
    TC_VERDICT_REFUSED,      /* it returned another error: the driver does not build the kernels, or not run them */
    TC_VERDICT_CRASHED,      /* the driver ended the process */
    TC_VERDICT_HUNG,         /* it did not end in time */
    TC_VERDICT_STOPPED,      /* somebody else ended the process, or memory ran out: the call fails, nothing is kept */
    TC_VERDICT_CANCELLED,    /* the caller does not want to wait: the library's call returns TC_ERROR_CANCELLED */
} tc_verdict;

/* Runs tc_trial_run(job) in a child process, with a limit of time, and tells how that ended. job: a line of text, to be
 * handed over as it is; valid during the callback. reason: room for a line of reason_bytes bytes, empty so far, for
 * tc_message() of that process, or for its last words. Called on the thread that called the library. */
typedef tc_verdict (*tc_child_trial)(void *user, const char *job, char *reason, size_t reason_bytes);

/* Terms: a work-group of work-items processes tiles; a tile is a run of bricks of 64 x 8 x 4 samples, or a run of
 * tetrahedra, within which counts are summed. Sums over tiles are made by decoupled look-back (Merrill and Garland,
 * "Single-pass parallel prefix scan with decoupled look-back", 2016). */
typedef struct tc_expert_options {
    size_t struct_size;  /* set by tc_expert_options_init */
    uint32_t work_items; /* per work-group: 1, or a multiple of 32 up to 1024; 0: default. 1 has kernels of its own, for
                            CPUs; TC_ERROR_ARGUMENT where the compiler is known to fail on them. Kernels that the device
                            runs with fewer only are built again for as many as it allows */
    uint32_t work_groups; /* launched at once; 0: default */
    uint32_t tile_bricks; /* bricks in a tile, at least; 0: default. Where work_items, work_groups and tile_bricks are
                             all 0, what tc_context_tuning_save has saved for the device is taken, if anything */
    uint32_t spin_limit; /* how often a tile polls the unfinished sum of the tile before, until it computes that itself;
                            0: default; 1: sums are computed again for every tile, which tests that path */
    tc_division division; /* TC_ERROR_ARGUMENT for one that the device does not have */
    int always_copy;      /* nonzero: samples are copied to device buffers and the mesh from them, also where the device
                             shares the host's memory and would use that in place. Slower; tests that path */
    tc_child_trial child_trial; /* tries drivers that are not known to be good, see tc_trial_run; NULL: they build
                                   kernels in this process at once */
    void *child_trial_user;     /* handed to child_trial */
} tc_expert_options;

/* Defaults: all 0. */
TC_API void tc_expert_options_init(tc_expert_options *options);

/* Trials of drivers. A driver that crashes or hangs takes the process with it. So the library can have it tried in
 * another process first: where child_trial is set, it is called before a device is opened, and before kernels of a kind
 * (of grid, type, method, missing samples, normals) are first built, unless driver and version are among those known to
 * be good. The library itself starts no process.
 *
 * The verdict is kept in the cache, for device, driver, versions and kernels, beside the programs that the trial has
 * built. Later contexts find both, of other processes and without a callback too. After a verdict that is not good the
 * library tries the other variant of the kernels (one work-item per group, or many) where work_items is 0. Where that
 * is not good either, the call fails with TC_ERROR_DEVICE or TC_ERROR_WRONG_RESULT and says what was found. tc_emit
 * that meets such kernels fails; count again after that. A caller's cl_context is tried on that device of tc_device_get
 * which it has; where it has none of them, but a part of one, it is used untried.
 *
 * tc_trial_run is what the child process calls. It does what the job says: it opens the device, builds the kernels,
 * runs them on a small volume and compares every byte with the reference engine's. progress, which may be NULL, is told
 * "run" when they are built. The driver may crash or hang in it, so the process has no other work; its environment is
 * the parent's. The tool does so by running itself. */
TC_API tc_status tc_trial_run(const char *job, tc_progress progress, void *progress_user);

/* How kernels are launched; fields as in tc_expert_options. */
typedef struct tc_tuning {
    size_t struct_size; /* set by the caller: sizeof(tc_tuning) */
    uint32_t work_items, work_groups, tile_bricks;
} tc_tuning;

/* Fills *tuning with what the context launches with: never 0 work_items or work_groups; 0 tile_bricks: as suits each
 * grid. TC_ERROR_ARGUMENT for the reference engine. */
TC_API tc_status tc_context_tuning(const tc_context *context, tc_tuning *tuning);

/* Saves that in the cache folder, for this device and driver: later contexts whose options leave all three at 0 launch
 * so. TC_ERROR_FILE where it cannot be written. */
TC_API tc_status tc_context_tuning_save(const tc_context *context);

#ifdef __cplusplus
}
#endif

#endif
