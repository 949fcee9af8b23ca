/* test_variant.c - which device gets which of the two variants of the kernels */
#include "expect.h"
#include "opencl/variant.h"

#include <stdio.h>

typedef struct expected {
    const char *platform, *type, *driver;
    kernel_variant variant;
    bool takes_alone, tried;
} expected;

static const expected devices[] = {
    {"Portable Computing Language", "cpu", "3.1+debian", VARIANT_ALONE, true, true},
    {"Portable Computing Language", "cpu", "9.9", VARIANT_ALONE, true, false},
    {"Portable Computing Language", "gpu", "3.1", VARIANT_GROUPS, true, false}, /* PoCL drives GPUs, too */
    {"Intel(R) OpenCL", "cpu", "2026.22.10.0.01_160000", VARIANT_ALONE, true, true},
    {"Intel(R) OpenCL Graphics", "gpu", "24.13.29138.7", VARIANT_GROUPS, true, false},
    {"rusticl", "cpu", "22.3.6", VARIANT_GROUPS, false, false}, /* builds in a process of its own first */
    {"rusticl", "cpu", "25.0.7-2+deb13u1", VARIANT_GROUPS, false, false},
    {"rusticl", "gpu", "99.0", VARIANT_GROUPS, false, false},
    {"Oclgrind", "cpu", "Oclgrind 21.10", VARIANT_GROUPS, true, true},
    {"NVIDIA CUDA", "gpu", "550.54.15", VARIANT_GROUPS, true, false},
    {"Somebody's OpenCL", "cpu", "1.0", VARIANT_GROUPS, true, false},
    {"", "other", "", VARIANT_GROUPS, true, false},
};

/* A known fault is that of one driver's versions. */
static void test_faults(void) {
    tc_device_info device = {.struct_size = sizeof device, .platform = "rusticl", .driver = "22.3.6"};
    snprintf(device.name, sizeof device.name, "llvmpipe (LLVM 15.0.6, 256 bits)");
    EXPECT(variant_fault(&device), "rusticl 22.3 with llvmpipe has no fault");
    snprintf(device.driver, sizeof device.driver, "25.0.7-2+deb13u1");
    EXPECT(!variant_fault(&device), "25.0.7: %s", variant_fault(&device));
    snprintf(device.driver, sizeof device.driver, "22.3.6");
    snprintf(device.name, sizeof device.name, "AMD Radeon");
    EXPECT(!variant_fault(&device), "another device: %s", variant_fault(&device));
}

int main(void) {
    for (size_t n = 0; n < sizeof devices / sizeof *devices; n++) {
        const expected *e = &devices[n];
        tc_device_info device = {.struct_size = sizeof device};
        snprintf(device.platform, sizeof device.platform, "%s", e->platform);
        snprintf(device.type, sizeof device.type, "%s", e->type);
        snprintf(device.driver, sizeof device.driver, "%s", e->driver);
        const variant_rule *rule = variant_rule_of(&device);
        EXPECT(rule->variant == e->variant, "%s, %s: variant %d", e->platform, e->type, (int)rule->variant);
        EXPECT(rule->takes_alone == e->takes_alone, "%s, %s: the variant for one work-item", e->platform, e->type);
        EXPECT(rule->takes_alone || rule->variant == VARIANT_GROUPS, "%s: gets what it does not take", e->platform);
        EXPECT(variant_tried(&device) == e->tried, "%s, %s: tried", e->platform, e->driver);
        EXPECT(*rule->why, "%s: no reason", e->platform);
    }
    test_faults();
    EXPECT(variant_for(1) == VARIANT_ALONE && variant_for(32) == VARIANT_GROUPS && variant_for(64) == VARIANT_GROUPS,
           "work-items");
    return EXPECT_DONE();
}
