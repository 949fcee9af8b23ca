/*
 * Method snap on a device: the kernels of snap.cl, before kernel 1 counts. They run over the window of sign words, the
 * whole grid where it holds that. Until kernel 1 counts, its buffers hold what snapping needs: lists of bricks near the
 * surface (active) and of those with violated samples (triangle_offsets), and words of these (offsets).
 */
#include "structured/structured_run.h"

#include "kernels/snap/link.h"

/* The window as one slab. */
static slab window_of(const run *r, slab_ref ref, const slab *s) {
    slab w = *s;
    w.z0 = s->results.word_z;
    w.z1 = slab_words_end(r->plan, r->grid, ref.slab_index);
    w.tiling.tile_count = tile_count_of(&w);
    return w;
}

static tc_status even_pass(const run *r, slab_ref ref, const slab *window) {
    const word_buffers *b = slab_words(r, ref);
    tc_status status = TC_OK;
    for (cl_uint colour = 0; colour < COLOUR_ODD && !status; colour++) {
        const kernel_argument arguments[] = {ARGUMENT(*window),
                                             ARGUMENT(colour),
                                             ARGUMENT(b->words.memory),
                                             ARGUMENT(b->bricks.memory),
                                             ARGUMENT(b->triangle_offsets.memory),
                                             ARGUMENT(r->context->work.state.memory),
                                             ARGUMENT(b->offsets.memory)};
        status = kernel_launch(r->context, r->kernels.snap[SNAP_PASS_EVEN], "kernel snap_even", arguments, 7);
    }
    return status;
}

tc_status window_snap(run *r, slab_ref ref, const slab *s) {
    const workspace *work = &r->context->work;
    const word_buffers *b = slab_words(r, ref);
    const slab window = window_of(r, ref, s);
    const kernel_argument sign[] = {ARGUMENT(window),
                                    ARGUMENT(slab_array(r, ref, ARRAY_SAMPLES)->memory),
                                    ARGUMENT(r->grid->device->ranges.memory),
                                    ARGUMENT(b->words.memory),
                                    ARGUMENT(b->bricks.memory),
                                    ARGUMENT(work->state.memory)};
    const kernel_argument near[] = {ARGUMENT(window), ARGUMENT(b->bricks.memory), ARGUMENT(b->active.memory),
                                    ARGUMENT(work->state.memory)};
    const kernel_argument violated[] = {ARGUMENT(window),
                                        ARGUMENT(slab_array(r, ref, ARRAY_SAMPLES)->memory),
                                        ARGUMENT(work->cells.memory),
                                        ARGUMENT(b->words.memory),
                                        ARGUMENT(b->bricks.memory),
                                        ARGUMENT(b->active.memory),
                                        ARGUMENT(work->state.memory),
                                        ARGUMENT(b->offsets.memory),
                                        ARGUMENT(b->triangle_offsets.memory)};
    const kernel_argument own[] = {ARGUMENT(window), ARGUMENT(b->words.memory), ARGUMENT(b->bricks.memory),
                                   ARGUMENT(b->triangle_offsets.memory), ARGUMENT(work->state.memory)};
    const kernel_argument odd[] = {ARGUMENT(window),
                                   ARGUMENT(b->words.memory),
                                   ARGUMENT(b->bricks.memory),
                                   ARGUMENT(b->triangle_offsets.memory),
                                   ARGUMENT(work->state.memory),
                                   ARGUMENT(b->offsets.memory)};
    const kernel_argument join[] = {ARGUMENT(window), ARGUMENT(b->words.memory), ARGUMENT(b->triangle_offsets.memory),
                                    ARGUMENT(work->state.memory), ARGUMENT(b->offsets.memory)};
    const sized_kernel *kernel = r->kernels.snap;
    tc_status status = kernel_launch(r->context, kernel[SNAP_SIGN], "kernel snap_sign", sign, 6);
    if (!status) status = kernel_launch(r->context, kernel[SNAP_NEAR], "kernel snap_near", near, 4);
    if (!status) status = kernel_launch(r->context, kernel[SNAP_VIOLATED], "kernel snap_violated", violated, 9);
    if (!status) status = kernel_launch(r->context, kernel[SNAP_WORDS], "kernel snap_words", own, 5);
    if (!status) status = even_pass(r, ref, &window);
    if (!status) status = kernel_launch(r->context, kernel[SNAP_PASS_ODD], "kernel snap_odd", odd, 6);
    if (!status) status = kernel_launch(r->context, kernel[SNAP_JOIN], "kernel snap_join", join, 5);
    return status;
}
