/*
 * plot3d_form.c - finds how a Plot3D file was written, from its size and its record marks; see plot3d_form.h
 *
 * Layout, after the PLOT3D User's Manual (Walatka, Buning, Pierce, Elson, NASA TM-101067, 1990) and, for solutions of
 * OVERFLOW, what VTK's vtkMultiBlockPLOT3DReader takes. Each line below is one Fortran record:
 *
 *     multi-block only:       blocks
 *     per block, all in one:  nx ny nz    (function: nx ny nz variables; OVERFLOW: after the last block's, NQ NQC)
 *     grid, per block:        x of all points, y, z, and IBLANK where there is one
 *     solution, per block:    Mach number, angle of attack, Reynolds number, time
 *                             density, momentum x y z, energy, each of all points
 *     OVERFLOW, per block:    7 values, an integer, 6 + max(2, NQC) values
 *                             NQ variables, each of all points
 *     function, per block:    each variable of all points
 *
 * C binary is the same without record marks; text is read into doubles first and then walked as C binary, its integers
 * being doubles too. A walk goes from record to record and never beyond the file, so nothing that a header claims is
 * acted on before the file is known to hold it.
 */
#include "plot3d/plot3d_form.h"

#include "exit_status.h"
#include "failure.h"
#include "plot3d/plot3d_text.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum {
    PADDING_LIMIT = 4096, /* files of record-oriented systems end with a storage block filled up with zeros */
    MAX_VARIABLES = 4096,
    PROBED_VALUES = 4096,
    MIN_OVERFLOW_VARIABLES = 5
};
static const double PHYSICAL_LOW = 1e-25, PHYSICAL_HIGH = 1e25;

typedef struct walk {
    const plot3d_file *file;
    plot3d_form *form;
    uint64_t position;
    uint64_t header_bytes, dims_at, variables, species;
    int64_t dims[3];  /* of the block that the walk has reached */
    uint64_t lacking; /* bytes that the file lacks, where the walk ended for that reason */
} walk;

/* ----------------------------------------------------------------------------------------------------------- values */

static uint64_t bits_at(const unsigned char *at, int bytes, int big_endian) {
    uint64_t bits = 0;
    if (bytes == 4) {
        uint32_t half;
        memcpy(&half, at, 4);
        return big_endian ? __builtin_bswap32(half) : half;
    }
    memcpy(&bits, at, 8);
    return big_endian ? __builtin_bswap64(bits) : bits;
}

static double value_at(const unsigned char *at, int bytes, int big_endian) {
    uint64_t bits = bits_at(at, bytes, big_endian);
    if (bytes == 4) {
        uint32_t half = (uint32_t)bits;
        float value;
        memcpy(&value, &half, 4);
        return (double)value;
    }
    double value;
    memcpy(&value, &bits, 8);
    return value;
}

void plot3d_load_f32(const plot3d_file *file, const plot3d_form *form, uint64_t offset, uint64_t count, float *out,
                     uint64_t stride) {
    const unsigned char *from = file->bytes + offset;
    int bytes = form->value_bytes, big_endian = form->big_endian;
    for (uint64_t i = 0; i < count; i++)
        out[i * stride] = (float)value_at(from + i * (uint64_t)bytes, bytes, big_endian);
}

void plot3d_load_f64(const plot3d_file *file, const plot3d_form *form, uint64_t offset, uint64_t count, double *out,
                     uint64_t stride) {
    const unsigned char *from = file->bytes + offset;
    int bytes = form->value_bytes, big_endian = form->big_endian;
    for (uint64_t i = 0; i < count; i++) out[i * stride] = value_at(from + i * (uint64_t)bytes, bytes, big_endian);
}

static int integer_bytes(const plot3d_form *form) { return form->encoding == PLOT3D_TEXT ? 8 : 4; }

/* -1 where it is no integer. */
static int64_t integer_at(const plot3d_file *file, const plot3d_form *form, uint64_t offset) {
    if (form->encoding != PLOT3D_TEXT) return (int32_t)bits_at(file->bytes + offset, 4, form->big_endian);
    double value = value_at(file->bytes + offset, 8, 0);
    return fabs(value) <= INT32_MAX && value == floor(value) ? (int64_t)value : -1;
}

int plot3d_is_blanked(const plot3d_file *file, const plot3d_form *form, const plot3d_block *block, uint64_t index) {
    return integer_at(file, form, block->iblank + index * (uint64_t)integer_bytes(form)) == 0;
}

int plot3d_is_physical(const plot3d_file *file, const plot3d_form *form) {
    for (int64_t n = 0; n < form->block_count; n++) {
        const plot3d_block *block = &form->blocks[n];
        uint64_t count = block->points * block->variables, step = count / PROBED_VALUES + 1;
        for (uint64_t i = 0; i < count; i += step) {
            double value;
            plot3d_load_f64(file, form, block->values + i * (uint64_t)form->value_bytes, 1, &value, 1);
            double size = fabs(value);
            if (!(size == 0 || (size >= PHYSICAL_LOW && size <= PHYSICAL_HIGH))) return 0;
        }
    }
    return 1;
}

/* ------------------------------------------------------------------------------------------------------------- walk */

/* Steps over the next record; nonzero where it is there, of this length. */
static int take(walk *w, uint64_t length, uint64_t *payload) {
    const plot3d_file *file = w->file;
    int mark = w->form->encoding == PLOT3D_RECORDS_4 ? 4 : w->form->encoding == PLOT3D_RECORDS_8 ? 8 : 0;
    uint64_t end, rest = file->size - w->position;
    if (mark && (rest < (uint64_t)mark || bits_at(file->bytes + w->position, mark, w->form->big_endian) != length))
        return 0;
    if (__builtin_add_overflow(length, 2 * (uint64_t)mark, &end)) return 0;
    if (end > rest) {
        w->lacking = end - rest;
        return 0;
    }
    *payload = w->position + (uint64_t)mark;
    w->position += end;
    return !mark || bits_at(file->bytes + w->position - mark, mark, w->form->big_endian) == length;
}

/* A record of values with, behind them, integers. */
static int take_values(walk *w, uint64_t values, uint64_t integers, uint64_t *payload) {
    uint64_t bytes, more;
    return !__builtin_mul_overflow(values, (uint64_t)w->form->value_bytes, &bytes) &&
           !__builtin_mul_overflow(integers, (uint64_t)integer_bytes(w->form), &more) &&
           !__builtin_add_overflow(bytes, more, &bytes) && take(w, bytes, payload);
}

static int take_header(walk *w) {
    plot3d_form *form = w->form;
    uint64_t one = (uint64_t)integer_bytes(form), at;
    int is_overflow = form->content == PLOT3D_OVERFLOW;
    form->block_count = 1;
    if (form->is_multi) {
        if (!take(w, one, &at)) return 0;
        form->block_count = integer_at(w->file, form, at);
        if (form->block_count < 1 || (uint64_t)form->block_count > w->file->size / (3 * one)) return 0;
    }
    w->header_bytes = (form->content == PLOT3D_FUNCTION ? 4 : 3) * one;
    uint64_t all = (uint64_t)form->block_count * w->header_bytes;
    if (!take(w, all + (is_overflow ? 2 * one : 0), &w->dims_at)) return 0;
    if (!is_overflow) return 1;
    int64_t variables = integer_at(w->file, form, w->dims_at + all);
    int64_t species = integer_at(w->file, form, w->dims_at + all + one);
    if (variables < MIN_OVERFLOW_VARIABLES || variables > MAX_VARIABLES || species < 0 || species > variables) return 0;
    w->variables = (uint64_t)variables;
    w->species = species > 2 ? (uint64_t)species : 2;
    return 1;
}

/* Reads the dims and, of a function, the number of variables. */
static int take_dims(walk *w, int64_t index, plot3d_block *block) {
    static const uint64_t variables[PLOT3D_CONTENTS] = {3, 3, 5, 0, 0};
    uint64_t one = (uint64_t)integer_bytes(w->form), at = w->dims_at + (uint64_t)index * w->header_bytes;
    *block = (plot3d_block){.points = 1, .variables = variables[w->form->content]};
    for (uint64_t a = 0; a < 3; a++) {
        w->dims[a] = block->dims[a] = integer_at(w->file, w->form, at + a * one);
        if (block->dims[a] < 1 || __builtin_mul_overflow(block->points, (uint64_t)block->dims[a], &block->points))
            return 0;
    }
    if (w->form->content == PLOT3D_OVERFLOW) block->variables = w->variables;
    if (w->form->content == PLOT3D_FUNCTION) {
        int64_t count = integer_at(w->file, w->form, at + 3 * one);
        if (count < 1 || count > MAX_VARIABLES) return 0;
        block->variables = (uint64_t)count;
    }
    return 1;
}

static int take_block(walk *w, int64_t index, plot3d_block *block) {
    uint64_t parameters, values, has_iblank = w->form->content == PLOT3D_GRID_IBLANK;
    if (!take_dims(w, index, block)) return 0;
    if (w->form->content == PLOT3D_SOLUTION && !take_values(w, 4, 0, &parameters)) return 0;
    if (w->form->content == PLOT3D_OVERFLOW && !take_values(w, 13 + w->species, 1, &parameters)) return 0;
    if (__builtin_mul_overflow(block->points, block->variables, &values) ||
        !take_values(w, values, has_iblank * block->points, &block->values))
        return 0;
    block->iblank = block->values + values * (uint64_t)w->form->value_bytes;
    return 1;
}

static int is_padding(const walk *w) {
    w->form->padding = w->file->size - w->position;
    if (w->form->padding >= PADDING_LIMIT) return 0;
    for (uint64_t i = w->position; i < w->file->size; i++)
        if (w->file->bytes[i] || w->form->encoding == PLOT3D_TEXT) return 0;
    return 1;
}

/* Nonzero where the form explains the file. Blocks are stored where form->blocks has room for them. */
static int walk_file(walk *w) {
    plot3d_block block;
    if (!take_header(w)) return 0;
    for (int64_t n = 0; n < w->form->block_count; n++)
        if (!take_block(w, n, w->form->blocks ? &w->form->blocks[n] : &block)) return 0;
    return is_padding(w);
}

/* ------------------------------------------------------------------------------------------------------------ forms */

const char *plot3d_describe(const plot3d_form *form, char text[128]) {
    static const char *const encodings[PLOT3D_ENCODINGS] = {"text", "Fortran records of 4-byte marks",
                                                            "Fortran records of 8-byte marks", "C binary"};
    static const char *const contents[PLOT3D_CONTENTS] = {"grid", "grid with IBLANK", "solution", "OVERFLOW solution",
                                                          "function"};
    int is_text = form->encoding == PLOT3D_TEXT;
    snprintf(text, 128, "%s%s%s, %s-block %s",
             is_text            ? ""
             : form->big_endian ? "big-endian "
                                : "little-endian ",
             encodings[form->encoding],
             is_text                  ? ""
             : form->value_bytes == 8 ? ", f64"
                                      : ", f32",
             form->is_multi ? "multi" : "single", contents[form->content]);
    return text;
}

/* Whether a walk came nearer to the file's form than another: record marks that agree are no chance; else the one that
 * lacks fewer bytes. */
static int is_nearer(const walk *w, const walk *other, const plot3d_form *other_form) {
    if (!w->lacking || !w->dims[0] || !other->lacking) return w->lacking && w->dims[0];
    int has_marks = w->form->encoding != PLOT3D_BINARY, other_has_marks = other_form->encoding != PLOT3D_BINARY;
    return has_marks == other_has_marks ? w->lacking < other->lacking : has_marks;
}

/* Adds the form where it explains the file, padding by its values too; else keeps the walk where it came nearest. */
static int try_form(plot3d_file *file, plot3d_form form, walk *nearest, plot3d_form *nearest_form) {
    walk w = {.file = file, .form = &form};
    if (!walk_file(&w)) {
        if (is_nearer(&w, nearest, nearest_form)) {
            *nearest = w;
            *nearest_form = form;
        }
        return 0;
    }
    form.blocks = calloc((size_t)form.block_count, sizeof *form.blocks);
    if (!form.blocks)
        return fail(STATUS_FAILED, "%s: no memory for its %" PRId64 " blocks", file->path, form.block_count);
    w = (walk){.file = file, .form = &form};
    walk_file(&w);
    if (form.padding && !plot3d_is_physical(file, &form))
        free(form.blocks);
    else
        file->forms[file->form_count++] = form;
    return 0;
}

static int no_form(const plot3d_file *file, const walk *nearest, const plot3d_form *form) {
    char text[128], near[320] = "";
    if (nearest->lacking)
        snprintf(near, sizeof near,
                 " Nearest: %s, but of a block of %" PRId64 " x %" PRId64 " x %" PRId64 " points at least %" PRIu64
                 " %s are missing.",
                 plot3d_describe(form, text), nearest->dims[0], nearest->dims[1], nearest->dims[2],
                 form->encoding == PLOT3D_TEXT ? nearest->lacking / 8 : nearest->lacking,
                 form->encoding == PLOT3D_TEXT ? "values" : "bytes");
    return fail(STATUS_INPUT,
                "%s: its size fits no 3D Plot3D grid, solution or function that its header could announce: %s were "
                "tried, single- and multi-block, with and without IBLANK. It is damaged, cut short or of another "
                "format.%s",
                file->path,
                file->numbers
                    ? "the numbers of its text"
                    : "Fortran records (4- and 8-byte marks) and C binary, little- and big-endian, f32 and f64",
                near);
}

int plot3d_open(const char *path, const mapping *mapped, plot3d_file *file) {
    int status = 0, is_text = plot3d_is_text(mapped);
    plot3d_form nearest_form = {0};
    walk nearest = {0};
    *file = (plot3d_file){.path = path, .bytes = mapped->bytes, .size = mapped->size};
    if (is_text) {
        if ((status = plot3d_numbers(path, mapped, &file->numbers, &file->size))) return status;
        file->bytes = (const unsigned char *)file->numbers;
        file->size *= sizeof *file->numbers;
    }
    for (int n = 0; n < PLOT3D_FORMS && !status; n++) {
        plot3d_form form = {.is_multi = n & 1,
                            .value_bytes = n & 2 ? 8 : 4,
                            .big_endian = n >> 2 & 1,
                            .encoding = (enum plot3d_encoding)((n >> 3) % PLOT3D_ENCODINGS),
                            .content = (enum plot3d_content)((n >> 3) / PLOT3D_ENCODINGS)};
        if (is_text != (form.encoding == PLOT3D_TEXT)) continue;
        if (is_text && (form.big_endian || form.value_bytes != 8)) continue;
        status = try_form(file, form, &nearest, &nearest_form);
    }
    return status || file->form_count ? status : no_form(file, &nearest, &nearest_form);
}

void plot3d_release(plot3d_file *file) {
    for (int n = 0; n < file->form_count; n++) free(file->forms[n].blocks);
    free(file->numbers);
    *file = (plot3d_file){0};
}
