/* carry.h - the fields that --carry names, from the points of the blocks to the vertices of a surface */
#ifndef CARRY_H
#define CARRY_H

#include "engine.h"

typedef struct carried {
    point_field *from;  /* what the input has */
    mesh_field *fields; /* of the vertices of the mesh last carried to */
    float **values;
    uint8_t *is_narrow; /* whose values float32 hardly tells apart, as has been told */
    int count;
} carried;

/* Finds the fields; none without --carry. To be released in any case. */
int carry_select(const options *o, dataset *d, carried *out);
void carry_release(carried *c);

/* Fills c->fields for the mesh that the engine has just made. */
int carry_to_mesh(carried *c, engine *e, const tc_extract_options *how, const tc_mesh_data *mesh);

#endif
