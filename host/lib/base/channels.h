/*
 * channels.h - sets of channels (vertex_values.h): what an extraction makes, and what buffers, windows, copies and
 * comparisons go through
 */
#ifndef CHANNELS_H
#define CHANNELS_H

#include "vertex_values.h"

#include <stdbool.h>
#include <stdint.h>

/* Bytes of a channel per vertex, of a triangle's indices, and of a triangle's two labels in a label map. */
enum { CHANNEL_BYTES = 12, TRIANGLE_BYTES = 12, LABELS_BYTES = 8 };

/* Those that are made: bit n is channel n. */
typedef uint32_t channel_set;

enum { POSITIONS_ALONE = 1 << CHANNEL_POSITIONS };

/* What the caller asks for: positions, and what the options name. */
channel_set channels_asked(const tc_extract_options *options);

bool channel_in(channel_set set, int channel);

/* Bytes of a mesh with these. */
uint64_t channels_mesh_bytes(channel_set set, uint64_t vertex_count, uint64_t triangle_count);

#endif
