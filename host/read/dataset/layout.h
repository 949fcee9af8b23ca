/*
 * layout.h - how a file stores its samples, and how one scalar volume is taken out of it
 *
 * A stored array has up to 16 axes, fastest first. At most three are of space; others hold several values per sample
 * (components) or several volumes (frames). The user chooses one component and one frame; the length of vectors takes
 * all components. What remains is a strided view. One loop gathers it for every format, byte order, 64-bit integers and
 * scaling included.
 */
#ifndef LAYOUT_H
#define LAYOUT_H

#include "dataset/dataset.h"
#include "dataset/request.h"
#include "stored_types.h"

enum { MAX_AXES = 16 };

enum axis_role { AXIS_SPACE, AXIS_COMPONENT, AXIS_FRAME };

typedef struct axes {
    int count;
    int64_t size[MAX_AXES]; /* each at least 1 */
    enum axis_role role[MAX_AXES];
    const char *meaning; /* of the components, "red, green, blue"; NULL where unknown */
} axes;

typedef struct layout {
    int element;               /* stored_types.h */
    int swapped;               /* the other byte order than this machine's */
    uint64_t count;            /* elements stored */
    uint64_t bytes;            /* of all of them */
    int64_t dims[3];           /* of the volume taken out */
    uint64_t stride[3];        /* elements from one sample to the next */
    int components;            /* values of a sample that are taken out; 0 counts as 1 */
    uint64_t component_stride; /* elements from one of them to the next */
    int64_t frames;            /* as in dataset */
    uint64_t offset;           /* element of the first sample */
    int scaled;                /* slope * value + intercept, in double */
    double slope;
    double intercept;
} layout;

/* Fills *out from the axes and the element; overflow and the choice of component and frame are checked. */
int layout_make(const char *path, const axes *from, int element, const read_request *request, layout *out);

/* Of the volume, only these samples are taken out. */
void layout_cut(layout *l, const sample_box *part);

/* The type of the samples taken out. */
tc_type layout_type(const layout *l);

/* Whether the samples can be used where they are, given the address of the stored array. */
int layout_is_plain(const layout *l, const unsigned char *stored);

/* Takes the volume out of the stored array: dims[0] * dims[1] * dims[2] samples of layout_type, with their components.
 * STATUS_INPUT where no double equals a 64-bit integer: up to its row, samples are then the nearest doubles. */
int layout_gather(const char *path, const layout *l, const unsigned char *stored, void *samples);

#endif
