/*
 * seeds.h - what the fuzzers start from: small files of every kind, made by the writers that the tests use
 */
#ifndef SEEDS_H
#define SEEDS_H

#include <stddef.h>

/* Writes a seed of a target, as it stands. */
void seed_write(const char *target, const char *name, const void *data, size_t size);

/* The same of a file, and a second one where `second` is given, with the options behind them (reader.c). */
void seed_file(const char *target, const char *name, const void *data, size_t size, const void *second,
               size_t second_size, const char options[4]);

void seeds_images(void); /* raw, NRRD, MetaImage, NIfTI */
void seeds_vtk(void);
void seeds_hdf5(void);
void seeds_plot3d(void);
void seeds_grids(void); /* arguments of the library */

#endif
