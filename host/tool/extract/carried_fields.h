/* carried_fields.h - the fields that --carry names, from the points of the blocks to the vertices of a surface */
#ifndef CARRIED_FIELDS_H
#define CARRIED_FIELDS_H

#include "engine.h"

typedef struct carried_fields {
    point_field *from;  /* what the input has */
    mesh_field *fields; /* of the vertices of the mesh last carried to */
    float **values;
    uint8_t *is_narrow; /* whose values float32 hardly tells apart, as has been told */
    int count;
} carried_fields;

/* Finds the fields; none without --carry. To be released in any case. */
int carried_fields_select(const options *o, dataset *d, carried_fields *out);
void carried_fields_release(carried_fields *c);

/* Fills c->fields for the mesh that the engine has just made. */
int carried_fields_interpolate(carried_fields *c, engine *e, const tc_extract_options *how, const tc_mesh_data *mesh);

#endif
