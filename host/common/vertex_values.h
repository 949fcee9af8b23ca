/*
 * vertex_values.h - what a mesh has for each vertex: channels, which an extraction makes, and fields that are carried
 *
 * Library, tool and writers go through the list of channels, and through arrays of values, not from name to name.
 */
#ifndef VERTEX_VALUES_H
#define VERTEX_VALUES_H

#include "tetracubes.h"

/* What values are to a file format. */
typedef enum vertex_role {
    ROLE_DATA, /* values that their name explains */
    ROLE_POSITIONS,
    ROLE_NORMALS,
    ROLE_COUNT
} vertex_role;

/* Values of the vertices of a mesh. */
typedef struct vertex_array {
    const char *name;
    int components;
    const float *values; /* tuple by tuple */
    vertex_role role;
} vertex_array;

/*
 * The channels. CHANNEL is applied to each:
 *
 *     CHANNEL(NAME, member, one, components, role, is_asked)
 *
 *     NAME      of CHANNEL_NAME
 *     member    of tc_mesh_data and tc_device_mesh; the name of its array, and of the channel in messages
 *     one       what messages call one of its tuples
 *     is_asked  whether the options, how, ask for it
 */
/* clang-format off */
#define CHANNELS(CHANNEL)                                                                                              \
    CHANNEL(POSITIONS, positions, "vertex", 3, ROLE_POSITIONS, 1)                                                      \
    CHANNEL(NORMALS, normals, "normal", 3, ROLE_NORMALS, how->normals)
/* clang-format on */

#define CHANNEL_NUMBER(NAME, ...) CHANNEL_##NAME,
enum { CHANNELS(CHANNEL_NUMBER) CHANNEL_COUNT };
#undef CHANNEL_NUMBER

typedef struct mesh_channel {
    const char *name, *one;
    int components;
    vertex_role role;
} mesh_channel;

#define CHANNEL_ROW(NAME, member, one, components, role, is_asked) {#member, one, components, role},
static const mesh_channel mesh_channels[CHANNEL_COUNT] = {CHANNELS(CHANNEL_ROW)};
#undef CHANNEL_ROW

static inline int channel_is_asked(const tc_extract_options *how, int channel) {
#define CHANNEL_ASKED(NAME, member, one, components, role, is_asked) is_asked,
    const int asked[CHANNEL_COUNT] = {CHANNELS(CHANNEL_ASKED)};
#undef CHANNEL_ASKED
    return asked[channel] != 0;
}

/* The channel's values; NULL where the mesh has none. */
static inline const float *mesh_values(const tc_mesh_data *mesh, int channel) {
#define CHANNEL_VALUES(NAME, member, ...) mesh->member,
    const float *const values[CHANNEL_COUNT] = {CHANNELS(CHANNEL_VALUES)};
#undef CHANNEL_VALUES
    return values[channel];
}

static inline void mesh_values_set(tc_mesh_data *mesh, int channel, const float *values) {
#define CHANNEL_MEMBER(NAME, member, ...) &mesh->member,
    const float **const members[CHANNEL_COUNT] = {CHANNELS(CHANNEL_MEMBER)};
#undef CHANNEL_MEMBER
    *members[channel] = values;
}

#endif
