/*
 * label_volume.h - the labels that are separated: those of a grid's samples, or a copy with the labels that are wanted
 *
 * Where all labels are wanted, the caller's samples are read where they are. A copy is made where some are not, which
 * then are background, as missing samples are; where samples are signed; and of closed surfaces, for which there is a
 * layer of background around the grid.
 */
#ifndef LABEL_VOLUME_H
#define LABEL_VOLUME_H

#include "grid/grid.h"

typedef struct label_volume {
    const tc_grid *grid;
    int64_t dims[3];
    int64_t before; /* layers of background around the grid: 0, or 1 */
    tc_type type;   /* TC_U8, TC_U16 or TC_U32 */
    const void *samples;
    void *own; /* memory of the copy, or NULL */
} label_volume;

/* To be released in any case. TC_ERROR_ARGUMENT for grids and options that label maps do not have. */
tc_status label_volume_make(const tc_grid *grid, const tc_labels_options *options, label_volume *out);
void label_volume_release(label_volume *v);

static inline uint32_t label_at(const label_volume *v, int64_t n) {
    return v->type == TC_U8    ? ((const uint8_t *)v->samples)[n]
           : v->type == TC_U16 ? ((const uint16_t *)v->samples)[n]
                               : ((const uint32_t *)v->samples)[n];
}

/* Of the cube at the first sample: 0 even. */
static inline unsigned label_volume_parity(const label_volume *v) {
    return (grid_parity(v->grid) ^ (unsigned)v->before) & 1; /* a layer more along all three axes */
}

#endif
