/*
 * libraries.h - the libraries that files need, and which of them this program was built with
 *
 * HAVE_ZLIB, HAVE_BZIP2 and so on are 1 or 0, from the build. The code that calls a library lies in a file of its own,
 * which is built where the library was found. Tables name its functions by IF_BUILT, which is NULL elsewhere.
 */
#ifndef LIBRARIES_H
#define LIBRARIES_H

enum library {
    LIBRARY_NONE,
    LIBRARY_ZLIB,
    LIBRARY_BZIP2,
    LIBRARY_LZ4,
    LIBRARY_LZMA,
    LIBRARY_NIFTI,
    LIBRARY_EXPAT,
    LIBRARY_TIFF,
    LIBRARY_HDF5
};

/* The function, or NULL. */
#define IF_BUILT(have, function)  IF_BUILT_(have, function)
#define IF_BUILT_(have, function) IF_BUILT_##have(function)
#define IF_BUILT_0(function)      NULL
#define IF_BUILT_1(function)      function

int library_is_built(enum library library);

/* STATUS_INPUT: the file `is` something ("holds bzip2 data") that needs a library which this program was built without.
 * The message says what helps `instead`, and how to build with it. */
int library_fail(enum library library, const char *path, const char *is, const char *instead);

#endif
