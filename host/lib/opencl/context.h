/*
 * context.h - a device with its queue, its built programs and the buffers it keeps between extractions
 */
#ifndef CONTEXT_H
#define CONTEXT_H

#include "kernels/tetrahedra/complex_job.h"
#include "base/spare_blocks.h"
#include "opencl/kernel_kind.h"
#include "opencl/opencl.h"
#include "sample_types.h"
#include "tetracubes.h"
#include "opencl/tuning.h"

#include <stdbool.h>
#include <sys/types.h>

/* A buffer that grows on demand and is kept between extractions. */
typedef struct device_buffer {
    cl_mem memory;
    uint64_t bytes;
    host_block block; /* its memory, on devices that work in the host's memory */
} device_buffer;

enum { KERNELS_MOST = 7, PROGRAM_OPTIONS_BYTES = 512 };

/* A program of kernels, built with certain options. */
typedef struct program {
    char asked[PROGRAM_OPTIONS_BYTES];   /* its options but for the work-items, which a kernel may allow fewer of */
    char options[PROGRAM_OPTIONS_BYTES]; /* those that it was built with */
    uint32_t work_items;                 /* per group: what its kernels are launched with */
    const char *source;
    bool cached; /* it came from the cache of built programs */
    cl_program program;
    cl_kernel kernels[KERNELS_MOST];
    struct program *next;
} program;

/* Results of kernel 1 for kernel 2, per word or brick of the window of sign words. */
typedef struct word_buffers {
    device_buffer words, offsets, triangle_offsets, bricks, active;
} word_buffers;

typedef struct mesh_buffers {
    device_buffer channels[CHANNEL_COUNT], triangles;
} mesh_buffers;

/* The arrays of a grid, with one or more values per sample or cube. */
enum { ARRAY_SAMPLES, ARRAY_POINTS, ARRAY_BLANKED_SAMPLES, ARRAY_BLANKED_CELLS, ARRAY_COUNT };

/* Results that the kernels of complexes pass to each other. */
typedef struct complex_buffers {
    device_buffer clusters, active_clusters, state, cases;
    device_buffer active, entries, table, tiles;
    device_buffer whole_cases;                        /* method hybrid */
    device_buffer cap_numbers, cap_firsts, cap_tiles; /* closed surfaces */
} complex_buffers;

/* What an interval volume of a complex takes: what is counted, crossed edges, numbers of vertices, the volume. */
typedef struct volume_buffers {
    device_buffer clusters, points, used, state, cases;
    device_buffer edges, slots, entries, table, numbers;
    device_buffer positions, tetrahedra;
} volume_buffers;

/* Of label maps: samples of a slab, results of kernel 1, and the mesh. */
typedef struct label_buffers {
    device_buffer samples, words, offsets, bases, rows, active, state;
    device_buffer tables[2]; /* [1] for mirrored grids */
    device_buffer positions, triangles, labels;
} label_buffers;

/* What an interval volume takes: kernel 1's results for both bounds, and its own. */
typedef struct interval_buffers {
    word_buffers words[2];
    device_buffer arrays[ARRAY_COUNT]; /* windows of the grid */
    device_buffer cells, state, scratch, rows, bricks, counts, cases, ticket;
    device_buffer parts[4]; /* of the volume */
} interval_buffers;

/* All buffers of kernels except arrays that the grid keeps whole on the device. The second window is used where copies
 * overlap kernels. */
typedef struct workspace {
    word_buffers words[2];
    device_buffer arrays[2][ARRAY_COUNT];
    mesh_buffers mesh[2];
    device_buffer cells; /* grids with missing samples */
    device_buffer state, scratch;
    complex_buffers complex;
    volume_buffers volume;
    label_buffers labels;
    interval_buffers interval;
    device_buffer cases[METHOD_COUNT][2][2]; /* table of each method; [1] for mirrored grids, for closed surfaces */
} workspace;

enum { SMOOTHING_BLOCKS = 3 };

struct tc_context {
    tc_context_options options; /* the caller's; pointers that are read once are NULL */
    tc_expert_options expert;   /* the caller's, or the defaults */
    launch_parameters launch;
    tc_device_info info;
    pid_t process;                          /* that made it */
    host_block smoothing[SMOOTHING_BLOCKS]; /* of label maps: kept between extractions */
    spare_blocks *spare;                    /* of results that were destroyed; NULL: none are kept */
    bool in_place;                          /* the device works in the host's memory: nothing is copied */
    cl_device_id device;
    cl_context context;
    cl_command_queue queue;
    cl_command_queue copies; /* made when copies first overlap kernels */
    program *programs;
    workspace work;
    bool for_trial;                        /* made for a trial: kernels are built without vetting */
    double progress_begin, progress_share; /* of a stream: the part of it that the call under way is */
    bool trial_runs;                       /* a trial is running: progress is not reported (trial.c) */
    bool variant_changed;                  /* the other variant was taken within a call, which starts again */
    bool vetted[KERNEL_KINDS + 1];         /* kernels that may be built, and the device itself (vetting.c) */
    const struct tc_grid *workspace_grid;  /* the grid that the workspace was last used for */
    const void *workspace_plan;            /* of a structured grid: its plan, of which it has several */
    bool trial_passed[KERNEL_KINDS];       /* kernels that were tried (trial.c) */
    const struct tc_grid *counted_grid;    /* whose counts the workspace holds since tc_count; NULL: none */
    const struct tc_grid *classified_grid; /* whose surface it holds, counted or extracted; NULL: none */
    uint64_t device_bytes, device_bytes_peak;
    double build_ms;                 /* that kernels took so far: built or loaded, vetted and tried */
    struct whole_cases *whole_cases; /* of method hybrid on complexes (whole_cases.h) */
    uint64_t whole_case_bytes;       /* of them, in the workspace */
};

/* Records "WHAT on DEVICE failed: CL_...", as opencl_fail does. */
tc_status context_fail(const tc_context *context, const char *what, cl_int error);

/* True in a forked child of the process that made the context. The child lacks the driver's threads, so commands would
 * never finish there; OpenCL objects are left alone. */
bool context_is_inherited(const tc_context *context);

/* TC_ERROR_DEVICE, with what to do, for such a context. */
tc_status context_check(const tc_context *context);

/* Waits for all commands, where they can end. */
void context_finish(const tc_context *context);

/* Reports progress to the caller; TC_ERROR_CANCELLED where the caller asks to stop. */
tc_status context_progress(const tc_context *context, const char *stage, double fraction);

/* Bytes of device memory that the library may use: as the caller allows; else all that the device has, or any number
 * where it works in the host's memory. */
uint64_t context_budget(const tc_context *context);

/* False where vertices of a wide type have to be made on the host. */
bool device_makes_vertices(const tc_context *context, tc_type type);

/* The size of a buffer of the caller's. TC_ERROR_ARGUMENT, naming it, where it is of another OpenCL context, no plain
 * buffer, or made with the flag `unfit`: CL_MEM_WRITE_ONLY for a buffer that kernels read, CL_MEM_READ_ONLY for one
 * that they write. */
tc_status buffer_inspect(const tc_context *context, cl_mem memory, cl_mem_flags unfit, const char *name, size_t *bytes);

/* Makes the queue of copies, in order like the other, where there is none yet. */
tc_status copies_queue_provide(tc_context *context);

/* Makes the buffer at least `bytes` large; its content is lost where it has to grow. name is for the error. */
tc_status buffer_reserve(tc_context *context, device_buffer *buffer, uint64_t bytes, const char *name);
void buffer_release(tc_context *context, device_buffer *buffer);
void mesh_buffers_release(tc_context *context, mesh_buffers *buffers);

/* Reserves it and copies the data to it, at once; on failure it is released, as a buffer that exists counts as filled.
 */
tc_status buffer_upload(tc_context *context, device_buffer *buffer, const void *data, uint64_t bytes, const char *name);

/* The host's array for kernels to read: in place from its page boundary on, where the device can, else a copy. *offset:
 * items before it in the buffer. */
tc_status buffer_provide(tc_context *context, device_buffer *buffer, const void *array, uint64_t bytes,
                         size_t item_bytes, uint64_t *offset, const char *name);

/* A buffer over memory of the host, which outlives it; counted against the device's memory while it exists. */
tc_status buffer_wrap(tc_context *context, device_buffer *buffer, void *memory, uint64_t bytes, cl_mem_flags access,
                      const char *name);

/* Bytes [first, end) of a block: wrapped from the page that they begin in, or a buffer of their own. *offset: 32-bit
 * items before them in it. */
tc_status mesh_part_open(tc_context *context, device_buffer *buffer, const host_block *block, uint64_t first,
                         uint64_t end, uint32_t *offset, const char *name);

/* Makes what the device wrote in the host's memory visible to the host. */
tc_status mesh_part_sync(tc_context *context, device_buffer *buffer);

/* Waits for what was written to the bytes, and brings it to the block where it is not there. */
tc_status mesh_part_close(tc_context *context, device_buffer *buffer, const host_block *block, uint64_t first,
                          uint64_t end);

/* Maps the first `bytes` of a buffer for the host to read; waits for earlier commands. */
tc_status buffer_map(tc_context *context, const device_buffer *buffer, uint64_t bytes, const void **memory);
tc_status buffer_unmap(tc_context *context, const device_buffer *buffer, const void *memory); /* NULL: nothing */

/* Releases the buffers that are kept between extractions. */
void workspace_release(tc_context *context);

/* Milliseconds of a clock that only runs forward. */
double clock_ms(void);

#endif
