#include "base/channels.h"

#define CHANNEL_NAME(name, many, one) many,
#define CHANNEL_ITEM(name, many, one) one,
const char *const channel_names[CHANNEL_COUNT] = {CHANNELS(CHANNEL_NAME)};
const char *const channel_items[CHANNEL_COUNT] = {CHANNELS(CHANNEL_ITEM)};

channel_set channels_asked(const tc_extract_options *options) {
    return POSITIONS_ALONE | (channel_set)(options->normals != 0) << CHANNEL_NORMALS;
}

bool channel_in(channel_set set, int channel) { return set >> channel & 1; }

uint64_t channels_mesh_bytes(channel_set set, uint64_t vertex_count, uint64_t triangle_count) {
    uint64_t bytes = triangle_count * TRIANGLE_BYTES;
    for (int channel = 0; channel < CHANNEL_COUNT; channel++)
        if (channel_in(set, channel)) bytes += vertex_count * CHANNEL_BYTES;
    return bytes;
}
