#include "picture_png.h"

#include "exit_status.h"
#include "failure.h"

#include <png.h>
#include <setjmp.h>

typedef struct png_sink {
    const char *path;
    output *o;
} png_sink;

static void take_bytes(png_structp png, png_bytep data, size_t bytes) {
    const png_sink *sink = png_get_io_ptr(png);
    output_bytes(sink->o, data, bytes);
}

static void flush_nothing(png_structp png) { (void)png; }

static void end_failed(png_structp png, png_const_charp text) {
    const png_sink *sink = png_get_error_ptr(png);
    fail(STATUS_FAILED, "%s: libpng: %s", sink->path, text);
    png_longjmp(png, 1);
}

static void warn_nobody(png_structp png, png_const_charp text) {
    (void)png;
    (void)text;
}

static void write_rows(png_structp png, png_infop info, const picture *p) {
    png_set_IHDR(png, info, (png_uint_32)p->width, (png_uint_32)p->height, 8, PNG_COLOR_TYPE_RGB, PNG_INTERLACE_NONE,
                 PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    png_set_sRGB(png, info, PNG_sRGB_INTENT_PERCEPTUAL);
    png_write_info(png, info);
    for (int y = 0; y < p->height; y++) png_write_row(png, p->pixels + (size_t)3 * (size_t)p->width * (size_t)y);
    png_write_end(png, info);
}

int picture_png(const picture *p, const char *path, output *o) {
    png_sink sink = {path, o};
    png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, &sink, end_failed, warn_nobody);
    png_infop info = png ? png_create_info_struct(png) : NULL;
    if (!info) {
        png_destroy_write_struct(&png, NULL);
        return fail(STATUS_FAILED, "out of memory for the picture's file");
    }
    if (setjmp(png_jmpbuf(png))) {
        png_destroy_write_struct(&png, &info);
        return STATUS_FAILED;
    }
    png_set_write_fn(png, &sink, take_bytes, flush_nothing);
    write_rows(png, info, p);
    png_destroy_write_struct(&png, &info);
    return 0;
}
