/*
 * tiff_pages.h - the pages of TIFF files, through libtiff
 *
 * Of a page, strips and tiles are read that are not packed, or by PackBits, LZW, Deflate, LZMA or Zstandard, whose
 * samples of one type lie beside each other. Pages of lower resolution, which are there for viewers, are passed over.
 * Before memory is taken, what the pages of a file declare is compared with what its bytes can hold at most.
 */
#ifndef TIFF_PAGES_H
#define TIFF_PAGES_H

#include "file/mapping.h"

#include <stdint.h>

/* What all pages of a volume have in common. */
typedef struct tiff_shape {
    int64_t width, height;
    int samples; /* of a pixel */
    int element; /* stored_types.h; in memory they have this machine's byte order */
} tiff_shape;

/* What pages beyond one plane are of, in a series. */
enum { TIFF_CHANNELS, TIFF_SLICES, TIFF_FRAMES, TIFF_DIMENSIONS };

/* What ImageJ or OME-TIFF (ome-model.readthedocs.io) say in the description of the first page. */
typedef struct tiff_notes {
    enum { TIFF_PLAIN, TIFF_IMAGEJ, TIFF_OME } writer;
    int64_t images;                 /* planes of the series */
    int64_t sizes[TIFF_DIMENSIONS]; /* of each dimension */
    int order[TIFF_DIMENSIONS];     /* the dimension that runs first, second and last */
    double spacing[3];
    const char *units; /* NULL: not known */
} tiff_notes;

/* Looks at every page of a mapped file: *pages is how many there are, *passed how many are passed over. The first page
 * of all fills *shape, whose width is 0 before, and *notes; the others have to have the same. */
int tiff_measure(const char *path, const mapping *file, tiff_shape *shape, tiff_notes *notes, int64_t *pages,
                 int64_t *passed);

/* Reads the pages that tiff_measure has counted to memory, one behind the other, row by row. */
int tiff_load(const char *path, const mapping *file, const tiff_shape *shape, int64_t pages, unsigned char *to);

/* Bytes of a page in memory. */
uint64_t tiff_page_bytes(const tiff_shape *shape);

#endif
