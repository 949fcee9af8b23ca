/* picture_png.h - the calls of libpng; for picture.c */
#ifndef PICTURE_PNG_H
#define PICTURE_PNG_H

#include "picture.h"

/* Puts the whole file into the output. Returns 0 or STATUS_FAILED with its text. */
int picture_png(const picture *p, const char *path, output *o);

#endif
