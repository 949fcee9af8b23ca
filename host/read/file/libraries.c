#include "file/libraries.h"

#include "exit_status.h"
#include "failure.h"

static const struct {
    const char *name, *package, *option;
    int is_built;
} libraries[] = {
    [LIBRARY_NONE] = {"", "", "", 1},
    [LIBRARY_ZLIB] = {"zlib", "zlib1g-dev", "TETRACUBES_ZLIB", HAVE_ZLIB},
    [LIBRARY_BZIP2] = {"libbz2", "libbz2-dev", "TETRACUBES_BZIP2", HAVE_BZIP2},
    [LIBRARY_LZ4] = {"liblz4", "liblz4-dev", "TETRACUBES_LZ4", HAVE_LZ4},
    [LIBRARY_LZMA] = {"liblzma", "liblzma-dev", "TETRACUBES_LZMA", HAVE_LZMA},
    [LIBRARY_NIFTI] = {"libnifti2", "libnifti2-dev", "TETRACUBES_NIFTI", HAVE_NIFTI},
    [LIBRARY_EXPAT] = {"expat", "libexpat1-dev", "TETRACUBES_EXPAT", HAVE_EXPAT},
    [LIBRARY_TIFF] = {"libtiff 4.5", "libtiff-dev", "TETRACUBES_TIFF", HAVE_TIFF},
    [LIBRARY_HDF5] = {"libhdf5", "libhdf5-dev", "TETRACUBES_HDF5", HAVE_HDF5},
};

int library_is_built(enum library library) { return libraries[library].is_built; }

int library_fail(enum library library, const char *path, const char *is, const char *instead) {
    return fail(STATUS_INPUT,
                "%s: %s, which this program was built without; %s, or build it with %s (Debian: %s) and %s=ON", path,
                is, instead, libraries[library].name, libraries[library].package, libraries[library].option);
}
