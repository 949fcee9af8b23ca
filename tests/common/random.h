/*
 * random.h - numbers that a seed repeats everywhere: splitmix64 (Steele, Lea, Flood 2014)
 */
#ifndef RANDOM_H
#define RANDOM_H

#include <stdint.h>

static uint64_t random_state;

static inline uint64_t random_u64(void) {
    uint64_t z = (random_state += 0x9e3779b97f4a7c15u);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
}

/* 0 <= n < limit. */
static inline uint32_t random_below(uint32_t limit) { return (uint32_t)((random_u64() >> 32) * limit >> 32); }

/* low <= x < high. */
static inline double random_between(double low, double high) {
    return low + (high - low) * (double)(random_u64() >> 11) * 0x1p-53;
}

#endif
