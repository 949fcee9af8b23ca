/* carried_fields.h - the fields that --carry names, from the points of the blocks to the vertices of a surface */
#ifndef CARRIED_FIELDS_H
#define CARRIED_FIELDS_H

#include "engine.h"

/* What a field's values on a surface are like. */
typedef struct carried_range {
    double low, high; /* of finite values; low above high where there are none */
    int is_beyond;    /* some are beyond float32 */
} carried_range;

typedef struct carried_fields {
    point_field *from;    /* what the input has */
    vertex_array *fields; /* of the vertices of the mesh last carried to */
    float **values;
    uint8_t *is_narrow; /* whose values float32 hardly tells apart, which has been told */
    carried_range *ranges;
    int count;
} carried_fields;

/* Finds the fields; none without --carry. To be released in any case. */
int carried_fields_select(const options *o, dataset *d, carried_fields *out);
void carried_fields_release(carried_fields *c);

/* To be called before the first mesh of a surface. */
void carried_fields_begin(carried_fields *c);

/* Fills c->fields for the mesh that the engine has just made of these blocks. */
int carried_fields_interpolate(carried_fields *c, engine *e, block_range blocks, const tc_extract_options *how,
                               const tc_mesh_data *mesh);

/* The same for a piece of a stream, of one block, whose planes have so many points. */
int carried_fields_of_piece(carried_fields *c, const tc_mesh_piece *piece, uint64_t plane_points,
                            const tc_extract_options *how);

/* Values are carried as float32: notices where that is too coarse for them, in all meshes of the surface. */
void carried_fields_tell(const carried_fields *c);

#endif
