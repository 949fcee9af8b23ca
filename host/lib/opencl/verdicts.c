#include "opencl/verdicts.h"

#include "opencl/cache.h"
#include "opencl/program.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char *const words[] = {[TC_VERDICT_GOOD] = "good",
                                    [TC_VERDICT_WRONG_RESULT] = "wrong",
                                    [TC_VERDICT_REFUSED] = "refused",
                                    [TC_VERDICT_CRASHED] = "crashed",
                                    [TC_VERDICT_HUNG] = "hung"};
enum { WORDS = sizeof words / sizeof *words, KEY_BYTES = 2048 };

static void line_end(char *text) {
    for (char *c = text; *c; c++)
        if ((unsigned char)*c < ' ') *c = ' ';
}

static void key_write(const tc_context *context, unsigned kind, char key[KEY_BYTES]) {
    const tc_device_info *d = &context->info;
    const launch_parameters *p = &context->launch;
    cl_platform_id platform = NULL;
    char device[1500], vendor[256] = "", version[256] = "";
    cl->GetDeviceInfo(context->device, CL_DEVICE_VENDOR, sizeof vendor, vendor, NULL);
    if (!cl->GetDeviceInfo(context->device, CL_DEVICE_PLATFORM, sizeof platform, &platform, NULL))
        cl->GetPlatformInfo(platform, CL_PLATFORM_VERSION, sizeof version, version, NULL);
    snprintf(device, sizeof device, "%s, %s, %s, %s, %s, driver %s", d->name, vendor, d->platform, version, d->version,
             d->driver);
    line_end(device);
    const int length = snprintf(key, KEY_BYTES, "tetracubes verdict 1\n%s\n", device), capacity = KEY_BYTES - length;
    if (kind == KERNEL_KINDS)
        snprintf(key + length, (size_t)capacity, "opened by tetracubes %s\n", tc_version());
    else
        snprintf(key + length, (size_t)capacity,
                 "kernels %u of tetracubes %s, %016" PRIx64 ": work-items %u, division %d, fp64 %d, in place %d\n",
                 kind, tc_version(), kernel_sources_hash(), p->work_items, (int)p->division, d->has_fp64,
                 context->in_place);
}

static void name_write(const char *key, char name[32]) {
    uint64_t hash = 0xcbf29ce484222325u;
    for (; *key; key++) hash = (hash ^ (unsigned char)*key) * 0x100000001b3u;
    snprintf(name, 32, "%016" PRIx64 ".verdict", hash);
}

void verdict_read(const tc_context *context, unsigned kind, kept_verdict *out) {
    char key[KEY_BYTES], name[32];
    cache_text file;
    *out = (kept_verdict){TC_VERDICT_NONE, ""};
    if (!cache_is_on()) return;
    key_write(context, kind, key);
    name_write(key, name);
    if (!cache_read(name, &file)) return;
    const size_t length = strlen(key);
    char *line = file.bytes + length, *end;
    if (file.count > length && !memcmp(file.bytes, key, length) && (end = memchr(line, '\n', file.count - length)) &&
        end + 1 == file.bytes + file.count) {
        *end = 0;
        for (int n = 1; n < WORDS; n++) {
            const size_t word = strlen(words[n]);
            if (strncmp(line, words[n], word) || strncmp(line + word, ": ", 2)) continue;
            out->verdict = (tc_verdict)n;
            snprintf(out->reason, sizeof out->reason, "%s", line + word + 2);
        }
    }
    free(file.bytes);
}

void verdict_write(const tc_context *context, unsigned kind, const kept_verdict *verdict) {
    char text[KEY_BYTES + sizeof verdict->reason + 32], key[KEY_BYTES], name[32], reason[sizeof verdict->reason];
    if (!cache_is_on()) return;
    key_write(context, kind, key);
    name_write(key, name);
    snprintf(reason, sizeof reason, "%s", verdict->reason);
    line_end(reason);
    int length = snprintf(text, sizeof text, "%s%s: %s\n", key, words[verdict->verdict], reason);
    cache_write(name, text, (size_t)length);
}

void verdict_path(const tc_context *context, unsigned kind, char *path, size_t bytes) {
    char key[KEY_BYTES], name[32];
    key_write(context, kind, key);
    name_write(key, name);
    if (!cache_path(name, path, bytes)) path[0] = 0;
}
