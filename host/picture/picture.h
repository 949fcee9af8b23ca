/*
 * picture.h - an image of 8-bit red, green and blue, and its file: PNG, by libpng where the program was built with it
 */
#ifndef PICTURE_H
#define PICTURE_H

#include "output_group.h"

enum { PICTURE_SIDE_LEAST = 16, PICTURE_SIDE_MOST = 8192 };

typedef struct picture {
    int width, height;
    unsigned char *pixels; /* row by row from the top, three bytes each */
} picture;

/* A white one, to be released. Returns 0, or STATUS_FAILED without memory. */
int picture_make(picture *p, int width, int height);
void picture_release(picture *p);

/* To be called before any work is done: 0 where the file can be a picture, else STATUS_USAGE: its name has to end in
 * .png, or be "-" for standard output. `option` is what messages call it. */
int picture_check(const char *option, const char *path);

/* Writes the PNG. It waits in the group, or appears at once where that is NULL. Returns 0 or a status with its text. */
int picture_write(const picture *p, const char *path, output_group *group);

#endif
