/*
 * joined_volume.h - the interval volume of all blocks as one set of tetrahedra, with the fields that are carried
 *
 * Vertices and tetrahedra of several blocks follow each other in the order of the blocks; nothing is merged.
 */
#ifndef JOINED_VOLUME_H
#define JOINED_VOLUME_H

#include "extract/carried_fields.h"
#include "extract/engine.h"
#include "volume_report.h"

typedef struct joined_volume {
    tc_interval_volume **blocks; /* of the engine's grids; NULL of a block with nothing in it */
    int block_count;
    tc_interval_volume_data sum; /* counts and times; positions and tetrahedra of all */
    float *positions;            /* those of several blocks; else NULL */
    uint32_t *tetrahedra;
    float **values; /* of each field, for all vertices */
    int field_count;
} joined_volume;

/* Only the sums of what tc_count_interval_volume tells of the blocks, into the report. */
int joined_volume_count(engine *e, const tc_interval_volume_options *how, volume_report *v);

/* Makes the volume; positions are relative to each block's own origin. To be released in any case. */
int joined_volume_make(engine *e, const tc_interval_volume_options *how, const carried_fields *carried,
                       joined_volume *out);
void joined_volume_release(joined_volume *v);

/* Adds its volume, and the integrals of its fields, to the report. */
int joined_volume_measure(const joined_volume *v, const carried_fields *carried, volume_report *report);

/* Whether the reference engine's has the same bytes. */
int joined_volume_verify(engine *reference, const tc_interval_volume_options *how, const joined_volume *v,
                         int *is_same);

/* Writes the file, in the world space of the dataset. */
int joined_volume_write(const joined_volume *v, const engine *e, const carried_fields *carried, const dataset *d,
                        const char *path);

#endif
