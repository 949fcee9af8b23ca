#include "picture.h"

#include "exit_status.h"
#include "failure.h"
#include "picture_png.h"

#include <stdlib.h>
#include <string.h>
#include <strings.h>

int picture_make(picture *p, int width, int height) {
    const size_t bytes = (size_t)3 * (size_t)width * (size_t)height;
    *p = (picture){.width = width, .height = height, .pixels = malloc(bytes)};
    if (!p->pixels) return fail(STATUS_FAILED, "out of memory for a picture of %d x %d pixels", width, height);
    memset(p->pixels, 255, bytes);
    return 0;
}

void picture_release(picture *p) {
    free(p->pixels);
    *p = (picture){0};
}

int picture_check(const char *option, const char *path) {
    const size_t length = strlen(path);
    const int has_ending = length > 4 && strcasecmp(path + length - 4, ".png") == 0;
    if (!has_ending && !output_is_dash(path))
        return fail(STATUS_USAGE, "%s %s: pictures are written as PNG: let the name end in .png", option, path);
    if (HAVE_PNG) return 0;
    return fail(STATUS_USAGE,
                "%s needs libpng, which this program was built without: build it with libpng (Debian: libpng-dev) and "
                "TETRACUBES_PNG=ON",
                option);
}

int picture_write(const picture *p, const char *path, output_group *group) {
    output o;
    int status = picture_check("picture", path);
    if (!status) status = output_open(&o, path);
    if (status) return status;
#if HAVE_PNG
    status = picture_png(p, path, &o);
#else
    (void)p; /* picture_check has refused it */
#endif
    if (!status) return group ? output_wait(&o, group) : output_close(&o);
    output_discard(&o);
    return status;
}
