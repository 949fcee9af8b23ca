/*
 * channels.h - what an extraction makes for each vertex: a list that buffers, windows, copies and comparisons go
 * through
 */
#ifndef CHANNELS_H
#define CHANNELS_H

#include "tetracubes.h"

#include <stdbool.h>
#include <stdint.h>

/* CHANNEL(NAME, names, one): messages speak of its names, and of one. Each has three floats per vertex. */
#define CHANNELS(CHANNEL)                                                                                              \
    CHANNEL(POSITIONS, "positions", "vertex")                                                                          \
    CHANNEL(NORMALS, "normals", "normal")

#define CHANNEL_NUMBER(name, many, one) CHANNEL_##name,
enum { CHANNELS(CHANNEL_NUMBER) CHANNEL_COUNT };

enum { CHANNEL_BYTES = 12, TRIANGLE_BYTES = 12 };

/* Those that are made: bit n is channel n. */
typedef uint32_t channel_set;

enum { POSITIONS_ALONE = 1 << CHANNEL_POSITIONS };

/* What the caller asks for: positions, and what the options name. */
channel_set channels_asked(const tc_extract_options *options);

bool channel_in(channel_set set, int channel);

/* Bytes of a mesh with these. */
uint64_t channels_mesh_bytes(channel_set set, uint64_t vertex_count, uint64_t triangle_count);

/* "positions", and one of them: "vertex". */
extern const char *const channel_names[CHANNEL_COUNT], *const channel_items[CHANNEL_COUNT];

#endif
