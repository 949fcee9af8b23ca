/*
 * memory_fault.h - memory of the host that runs out: preloaded into a program, it fails the Nth request of the
 * library's
 *
 * Method: stands before the C library's malloc, calloc, realloc, aligned_alloc, posix_memalign, strdup, strndup,
 * asprintf, realpath, open_memstream and mmap (LD_PRELOAD). Only requests that come from libtetracubes are counted and
 * failed, and those of the program itself and of the libraries that it reads formats with where the environment's
 * TETRACUBES_MEMORY_FAULT holds a number N: that of the request that fails, 0 for none. Then, too, a line at the end
 * tells on standard error how many there were. What the C library and the drivers need for themselves they get.
 */
#ifndef MEMORY_FAULT_H
#define MEMORY_FAULT_H

typedef struct memory_fault_functions {
    /* Request n from now on fails, of those counted; 0: none does. */
    void (*fail)(unsigned long n);
    /* Memory that is given from now on is full of this byte, where it need not be 0; -1: as it comes. */
    void (*fill)(int byte);
    /* Requests since then, and how many of them have failed. */
    unsigned long (*requests)(void);
    unsigned long (*failed)(void);
    /* What has been given and not been freed: pieces of memory, and bytes of mappings. */
    long (*pieces)(void);
    long (*mapped_bytes)(void);
} memory_fault_functions;

extern const memory_fault_functions memory_fault_control;

#endif
