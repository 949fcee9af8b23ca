/*
 * bandwidth.cl - how fast a device reads and writes its global memory
 *
 * Every work-group walks one contiguous chunk, four accesses of each item in flight. The items of a group are
 * neighbours: a group of one streams, as CPUs like it, a wide group coalesces, as GPUs do. chunk is in vectors and a
 * multiple of four times the group's size.
 *
 * Build options: VECTOR, an unsigned vector type, and WIDTH, its components; STREAMING, stores that pass the caches by.
 */
#ifdef STREAMING
#define STORE(value, address) __builtin_nontemporal_store(value, address)
#else
#define STORE(value, address) (*(address) = (value))
#endif

/* The sink keeps the loads from being dropped. It is hardly ever written, and never read. */
kernel void bandwidth_read(global const VECTOR *memory, ulong chunk, global uint *sink) {
    const size_t step = get_local_size(0);
    global const VECTOR *first = memory + get_group_id(0) * chunk, *end = first + chunk;
    VECTOR a = 0, b = 0, c = 0, d = 0;
    for (global const VECTOR *at = first + get_local_id(0); at < end; at += 4 * step) {
        a ^= at[0];
        b ^= at[step];
        c ^= at[2 * step];
        d ^= at[3 * step];
    }
    union {
        VECTOR vector;
        uint words[WIDTH];
    } sum;
    sum.vector = (a ^ b) + (c ^ d);
    uint total = 0;
    for (int n = 0; n < WIDTH; n++) total += sum.words[n];
    if (total == 0x9e3779b9u) sink[0] = total;
}

kernel void bandwidth_write(global VECTOR *memory, ulong chunk, uint value) {
    const size_t step = get_local_size(0);
    global VECTOR *first = memory + get_group_id(0) * chunk, *end = first + chunk;
    const VECTOR filling = value;
    for (global VECTOR *at = first + get_local_id(0); at < end; at += 4 * step) {
        STORE(filling, at);
        STORE(filling, at + step);
        STORE(filling, at + 2 * step);
        STORE(filling, at + 3 * step);
    }
}
