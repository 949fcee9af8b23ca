#include "opencl/variant.h"

#include <string.h>

/* The first that fits. A device nobody knows gets the plain variant, processors too: a compiler that does not know the
 * extensions of the other may abort the process. Nothing but speed depends on the choice.
 *
 * PoCL 6.0 with LLVM 18 or 19 asks the optimiser to check itself (pass instcombine, verify-fixpoint), and aborts the
 * process where code could be simplified twice. The kernels do not trigger that now, but nothing guarantees it.
 * Mesa drops a write to a struct's member where the struct is copied and the member written again, and does so by
 * how loops are unrolled. The kernels do not trigger that either, and nothing guarantees it.
 * So these versions do not count as tried: where a trial is asked for, they first build in a process of their own. */
static const variant_rule rules[] = {
    {"Portable Computing Language", "cpu", VARIANT_ALONE, true, "3.1",
     "PoCL compiles by Clang; one work-item per group is three times as fast there"},
    {"Intel(R) OpenCL", "cpu", VARIANT_ALONE, true, "2026.", "Intel's compiler for CPUs is built on Clang"},
    {"Oclgrind", NULL, VARIANT_GROUPS, true, "Oclgrind 21.10",
     "it simulates instructions one by one and knows no prefetching unless that is defined away"},
    {"rusticl", NULL, VARIANT_GROUPS, false, "",
     "Mesa compiles by way of SPIR-V, whose vectors have 16 elements at the most: its translator aborts on longer "
     "ones"},
    {"Clover", NULL, VARIANT_GROUPS, false, "", "Mesa's older implementation, never tried"},
    {NULL, NULL, VARIANT_GROUPS, true, "", "nothing is known about it"},
};

static bool contains(const char *text, const char *part) { return !part || strstr(text, part); }

const variant_rule *variant_rule_of(const tc_device_info *device) {
    const variant_rule *rule = rules;
    while (!contains(device->platform, rule->platform) || !contains(device->type, rule->type)) rule++;
    return rule;
}

bool variant_tried(const tc_device_info *device) {
    const char *version = variant_rule_of(device)->tried;
    while (*version) {
        const size_t length = strcspn(version, " ");
        if (!strncmp(device->driver, version, length)) return true;
        version += length + (version[length] == ' ');
    }
    return false;
}

/* Kernels here are right on small volumes only. */
static const struct driver_fault {
    const char *platform, *name, *driver, *what; /* name: part of the device's; driver: what its version begins with */
} faults[] = {
    {"rusticl", "llvmpipe", "22.3", "ends loops after 65535 rounds of a work-item, all loops together"},
};

const char *variant_fault(const tc_device_info *device) {
    for (size_t n = 0; n < sizeof faults / sizeof *faults; n++)
        if (contains(device->platform, faults[n].platform) && contains(device->name, faults[n].name) &&
            !strncmp(device->driver, faults[n].driver, strlen(faults[n].driver)))
            return faults[n].what;
    return NULL;
}

kernel_variant variant_for(uint32_t work_items) { return work_items == 1 ? VARIANT_ALONE : VARIANT_GROUPS; }
