/*
 * A file per program: a head, the key, the binary.
 *
 * The key is the text of all that determines the binary: device, vendor, versions, options, sources. It is stored and
 * compared whole, so the hash in the file's name only has to be well distributed: FNV-1a, two lines, is enough. The
 * checksum finds damage: an implementation handed half a binary may crash. A file that is not right in every byte is as
 * good as none, and is replaced after the next build.
 */
#include "opencl/program_cache.h"

#include "opencl/cache.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct head {
    char magic[16];
    uint64_t key_bytes, binary_bytes;
    uint64_t checksum; /* of key and binary */
} head;

static const char magic[] = "tetracubes prg 1"; /* stored without the terminating 0 */

static uint64_t hash_of(const char *bytes, size_t count) {
    uint64_t hash = 0xcbf29ce484222325u;
    for (size_t n = 0; n < count; n++) hash = (hash ^ (unsigned char)bytes[n]) * 0x100000001b3u;
    return hash;
}

/* ------------------------------------------------------------------------------------------------------------- key */

static void line_write(FILE *out, const char *text) { fprintf(out, "%s\n", text); }

/* False where the device does not tell who made it. */
static bool device_lines_write(FILE *out, const tc_context *context) {
    cl_platform_id platform = NULL;
    char vendor[256] = "", version[256] = "";
    if (cl->GetDeviceInfo(context->device, CL_DEVICE_VENDOR, sizeof vendor, vendor, NULL) ||
        cl->GetDeviceInfo(context->device, CL_DEVICE_PLATFORM, sizeof platform, &platform, NULL) ||
        cl->GetPlatformInfo(platform, CL_PLATFORM_VERSION, sizeof version, version, NULL))
        return false;
    line_write(out, context->info.name);
    line_write(out, vendor);
    line_write(out, context->info.version);
    line_write(out, context->info.driver);
    line_write(out, context->info.platform);
    line_write(out, version);
    return true;
}

/* bytes NULL where memory is out, or the device does not tell enough. */
static cache_text key_make(const tc_context *context, const program_recipe *recipe) {
    cache_text key = {0};
    FILE *out = open_memstream(&key.bytes, &key.count);
    if (!out) return (cache_text){0};
    bool failed = !device_lines_write(out, context);
    line_write(out, recipe->options);
    line_write(out, recipe->source);
    failed |= ferror(out) != 0;
    if (!fclose(out) && !failed) return key;
    free(key.bytes);
    return (cache_text){0};
}

static void name_write(cache_text key, char name[32]) {
    snprintf(name, 32, "%016" PRIx64 ".program", hash_of(key.bytes, key.count));
}

/* ------------------------------------------------------------------------------------------------------------ load */

/* The binary within the file; NULL where the file is not of this key, or damaged. */
static const unsigned char *binary_find(cache_text file, cache_text key, size_t *bytes) {
    head h;
    if (file.count < sizeof h) return NULL;
    memcpy(&h, file.bytes, sizeof h);
    size_t rest = file.count - sizeof h;
    const char *content = file.bytes + sizeof h;
    if (memcmp(h.magic, magic, sizeof h.magic) || h.key_bytes != key.count || h.key_bytes > rest ||
        h.binary_bytes != rest - h.key_bytes || memcmp(content, key.bytes, key.count) ||
        h.checksum != hash_of(content, rest))
        return NULL;
    *bytes = (size_t)h.binary_bytes;
    return (const unsigned char *)content + key.count;
}

static cl_program binary_build(const tc_context *context, const char *options, const unsigned char *binary,
                               size_t bytes) {
    cl_int error, of_device = CL_SUCCESS;
    cl_program built =
        cl->CreateProgramWithBinary(context->context, 1, &context->device, &bytes, &binary, &of_device, &error);
    if (error) return NULL;
    if (!of_device && !cl->BuildProgram(built, 1, &context->device, options, NULL, NULL)) return built;
    cl->ReleaseProgram(built);
    return NULL;
}

cl_program program_cache_load(const tc_context *context, const program_recipe *recipe) {
    char name[32];
    cache_text file;
    size_t bytes = 0;
    cl_program built = NULL;
    cache_text key = cache_is_on() ? key_make(context, recipe) : (cache_text){0};
    if (!key.bytes) return NULL;
    name_write(key, name);
    if (cache_read(name, &file)) {
        const unsigned char *binary = binary_find(file, key, &bytes);
        if (binary) built = binary_build(context, recipe->options, binary, bytes);
        free(file.bytes);
    }
    free(key.bytes);
    return built;
}

/* ----------------------------------------------------------------------------------------------------------- store */

enum { DEVICES_MOST = 64 };

/* The index of the context's device among the program's devices. These are all devices of the OpenCL context, which may
 * be the caller's. */
typedef struct device_slot {
    cl_uint index, count;
} device_slot;

static bool device_slot_find(const tc_context *context, cl_program built, device_slot *at) {
    cl_device_id devices[DEVICES_MOST];
    size_t bytes = 0;
    if (cl->GetProgramInfo(built, CL_PROGRAM_DEVICES, sizeof devices, devices, &bytes)) return false;
    at->count = (cl_uint)(bytes / sizeof *devices);
    for (at->index = 0; at->index < at->count; at->index++)
        if (devices[at->index] == context->device) return true;
    return false;
}

/* 0 where the implementation gives no binary. */
static size_t binary_bytes(cl_program built, device_slot at) {
    size_t sizes[DEVICES_MOST] = {0};
    cl_int error = cl->GetProgramInfo(built, CL_PROGRAM_BINARY_SIZES, at.count * sizeof *sizes, sizes, NULL);
    return error ? 0 : sizes[at.index];
}

static bool binary_get(cl_program built, device_slot at, char *out) {
    unsigned char *binaries[DEVICES_MOST] = {NULL}; /* those of other devices are not asked for */
    binaries[at.index] = (unsigned char *)out;
    return !cl->GetProgramInfo(built, CL_PROGRAM_BINARIES, at.count * sizeof *binaries, binaries, NULL);
}

/* Head, key and binary in one; bytes NULL where that cannot be had. */
static cache_text file_make(cl_program built, device_slot at, cache_text key) {
    head h = {.key_bytes = key.count, .binary_bytes = binary_bytes(built, at)};
    cache_text file = {.count = sizeof h + key.count + (size_t)h.binary_bytes};
    if (!h.binary_bytes || !(file.bytes = malloc(file.count))) return (cache_text){0};
    char *content = file.bytes + sizeof h;
    memcpy(content, key.bytes, key.count);
    if (!binary_get(built, at, content + key.count)) {
        free(file.bytes);
        return (cache_text){0};
    }
    memcpy(h.magic, magic, sizeof h.magic);
    h.checksum = hash_of(content, file.count - sizeof h);
    memcpy(file.bytes, &h, sizeof h);
    return file;
}

void program_cache_store(const tc_context *context, const program_recipe *recipe, cl_program built) {
    char name[32];
    device_slot at;
    if (!cache_is_on() || !device_slot_find(context, built, &at)) return;
    cache_text key = key_make(context, recipe);
    if (!key.bytes) return;
    cache_text file = file_make(built, at, key);
    name_write(key, name);
    if (file.bytes) cache_write(name, file.bytes, file.count);
    free(file.bytes);
    free(key.bytes);
}
