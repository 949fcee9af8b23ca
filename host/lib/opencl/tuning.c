#include "opencl/tuning.h"

#include "opencl/cache.h"
#include "failure.h"
#include "kernels/base/slab.h"
#include "opencl/variant.h"

#include <errno.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char file_name[] = "tuning";

static const struct {
    const char *name;
    size_t offset;
} parameters[] = {
    {"work_items=", offsetof(tc_tuning, work_items)},
    {"work_groups=", offsetof(tc_tuning, work_groups)},
    {"tile_bricks=", offsetof(tc_tuning, tile_bricks)},
};
enum { PARAMETERS = sizeof parameters / sizeof *parameters };

static const uint32_t work_items_most = 1024; /* CPUs keep the variables of all work-items of a group on one stack */
static const uint32_t kept_most = 1u << 16;   /* more groups, or bricks, would only use memory */

/* Groups share bricks, for each of which they need local memory. */
static uint32_t work_items_limit(const tc_device_info *device) {
    uint64_t most = device->max_work_group_size;
    uint64_t by_memory = device->local_memory_bytes / LOCAL_BYTES_PER_BRICK * BRICK_WORDS;
    if (by_memory && by_memory < most) most = by_memory;
    return most < work_items_most ? (uint32_t)most : work_items_most;
}

static bool work_items_fit(const tc_device_info *device, uint32_t count) {
    if (count == 1) return variant_rule_of(device)->takes_alone;
    return count % 32 == 0 && count <= work_items_limit(device);
}

/* ------------------------------------------------------------------------------------------------------------ file */

/* One line. The units are part of it: cores given to a machine change, its processor's name does not. */
static void device_text(const tc_device_info *d, char out[1024]) {
    snprintf(out, 1024, "device=%s, %u units, %s, %s, driver %s", d->name, d->compute_units, d->platform, d->version,
             d->driver);
    for (char *c = out; *c; c++)
        if ((unsigned char)*c < ' ') *c = ' ';
}

/* Parses the parameters at the start of a line; returns the text after them, NULL where the form is another. */
static const char *parameters_parse(const char *line, tc_tuning *out) {
    for (int n = 0; n < PARAMETERS; n++) {
        size_t length = strlen(parameters[n].name);
        if (strncmp(line, parameters[n].name, length) || line[length] < '0' || line[length] > '9') return NULL;
        char *end;
        errno = 0;
        unsigned long value = strtoul(line + length, &end, 10);
        if (errno || value > kept_most || *end != ' ') return NULL;
        *(uint32_t *)((char *)out + parameters[n].offset) = (uint32_t)value;
        line = end + 1;
    }
    return line;
}

/* The parameters that the file has for the device, where they are within its limits. */
static bool kept_find(const tc_device_info *device, tc_tuning *out) {
    char name[1024], *rest = NULL;
    cache_text file;
    bool found = false;
    if (!cache_read(file_name, &file)) return false;
    device_text(device, name);
    for (char *line = strtok_r(file.bytes, "\n", &rest); line && !found; line = strtok_r(NULL, "\n", &rest)) {
        const char *of = parameters_parse(line, out);
        found = of && !strcmp(of, name) && (!out->work_items || work_items_fit(device, out->work_items));
    }
    free(file.bytes);
    return found;
}

static void line_write(FILE *out, const tc_tuning *tuning, const char *device) {
    for (int n = 0; n < PARAMETERS; n++)
        fprintf(out, "%s%u ", parameters[n].name, *(const uint32_t *)((const char *)tuning + parameters[n].offset));
    fprintf(out, "%s\n", device);
}

/* Writes the lines of other devices unchanged. */
static void others_write(FILE *out, const char *device) {
    cache_text file;
    char *rest = NULL;
    if (!cache_read(file_name, &file)) return;
    for (char *line = strtok_r(file.bytes, "\n", &rest); line; line = strtok_r(NULL, "\n", &rest)) {
        const char *of = strstr(line, "device=");
        if (of && strcmp(of, device)) fprintf(out, "%s\n", line);
    }
    free(file.bytes);
}

tc_status tuning_keep(const tc_device_info *device, const tc_tuning *tuning) {
    char name[1024];
    cache_text text = {0};
    FILE *out = open_memstream(&text.bytes, &text.count);
    if (!out) return (tc_status)fail(TC_ERROR_MEMORY, "no memory for the tuning file");
    device_text(device, name);
    line_write(out, tuning, name);
    others_write(out, name);
    bool done = !ferror(out);
    done = !fclose(out) && done && cache_write(file_name, text.bytes, text.count);
    free(text.bytes);
    return done ? TC_OK
                : (tc_status)fail(TC_ERROR_FILE, "the tuning file cannot be written: see that TETRACUBES_CACHE_DIR is "
                                                 "unset, or names a folder of yours that you alone can write to");
}

/* ---------------------------------------------------------------------------------------------------------- choice */

/* All or none: they were measured together. */
static void kept_take(const tc_device_info *device, launch_parameters *p) {
    tc_tuning kept = {0};
    if (p->work_items || p->work_groups || p->scan.tile_bricks || !kept_find(device, &kept)) return;
    p->work_items = kept.work_items;
    p->work_groups = kept.work_groups;
    p->scan.tile_bricks = kept.tile_bricks;
}

/* Polls of an unfinished tile. Recomputing one costs a CPU as long as about 2^17 polls take. */
static const uint32_t spins = 1u << 14, spins_cpu = 1u << 17;

/* A work-item per tile where the text for that is taken, a work-item per row of a brick elsewhere, on CPUs of one
 * brick; groups to fill the device. One work-item too where a group has no room for a brick. */
static void defaults_take(const tc_device_info *device, launch_parameters *p) {
    const bool cpu = !strcmp(device->type, "cpu");
    const bool alone = variant_rule_of(device)->variant == VARIANT_ALONE;
    const uint64_t most = device->max_work_group_size;
    if (!p->work_items) p->work_items = alone || most < 32 ? 1 : cpu || most < 128 ? 32 : 128;
    if (!p->work_groups) p->work_groups = device->compute_units * (cpu ? 1 : 8);
    if (!p->scan.spin_limit) p->scan.spin_limit = cpu ? spins_cpu : spins;
    if (p->division == TC_DIVISION_DEFAULT)
        p->division = device->rounds_division ? TC_DIVISION_BUILT_IN
                      : device->has_fp64      ? TC_DIVISION_FP64
                                              : TC_DIVISION_INTEGER;
}

tc_status tuning_choose(const tc_expert_options *options, const tc_device_info *device, launch_parameters *p) {
    *p = (launch_parameters){.work_items = options->work_items,
                             .work_groups = options->work_groups,
                             .scan = {options->tile_bricks, options->spin_limit},
                             .division = options->division};
    kept_take(device, p);
    defaults_take(device, p);
    if (!options->work_items) p->other_items = p->work_items > 1 ? 1 : 32;
    if (p->other_items && !work_items_fit(device, p->other_items)) p->other_items = 0;
    if (p->work_items == 1 && !work_items_fit(device, 1))
        return (tc_status)fail(
            TC_ERROR_ARGUMENT,
            "work_items 1: the compiler of %s is known not to take the kernels for one work-item per "
            "group; a multiple of 32, or 0 for the default",
            device->platform);
    if (!work_items_fit(device, p->work_items))
        return (tc_status)fail(TC_ERROR_ARGUMENT, "work_items %u: 1, or a multiple of 32 up to %u on this device",
                               p->work_items, work_items_limit(device));
    if (p->division < TC_DIVISION_BUILT_IN || p->division > TC_DIVISION_INTEGER)
        return (tc_status)fail(TC_ERROR_ARGUMENT, "%d is no division", (int)p->division);
    if ((p->division == TC_DIVISION_BUILT_IN && !device->rounds_division) ||
        (p->division == TC_DIVISION_FP64 && !device->has_fp64))
        return (tc_status)fail(TC_ERROR_ARGUMENT, "this device cannot divide by TC_DIVISION_%s",
                               p->division == TC_DIVISION_FP64 ? "FP64: it has no fp64"
                                                               : "BUILT_IN: it does not round correctly");
    return TC_OK;
}
