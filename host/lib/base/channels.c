#include "base/channels.h"

#define CHANNEL_HAS_ROOM(NAME, member, one, components, role, is_asked)                                                \
    _Static_assert((components) * sizeof(float) == CHANNEL_BYTES, "windows of " #member " have other offsets");
CHANNELS(CHANNEL_HAS_ROOM)

channel_set channels_asked(const tc_extract_options *options) {
    channel_set asked = 0;
    for (int channel = 0; channel < CHANNEL_COUNT; channel++)
        asked |= (channel_set)channel_is_asked(options, channel) << channel;
    return asked;
}

bool channel_in(channel_set set, int channel) { return set >> channel & 1; }

uint64_t channels_mesh_bytes(channel_set set, uint64_t vertex_count, uint64_t triangle_count) {
    uint64_t bytes = triangle_count * TRIANGLE_BYTES;
    for (int channel = 0; channel < CHANNEL_COUNT; channel++)
        if (channel_in(set, channel)) bytes += vertex_count * CHANNEL_BYTES;
    return bytes;
}
