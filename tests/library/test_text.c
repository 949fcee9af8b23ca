/* test_text.c - which device gets which of the two texts of the kernels */
#include "expect.h"
#include "opencl/text.h"

#include <stdio.h>

typedef struct expected {
    const char *platform, *type, *driver;
    kernel_text text;
    bool takes_alone, tried;
} expected;

static const expected devices[] = {
    {"Portable Computing Language", "cpu", "3.1+debian", TEXT_ALONE, true, true},
    {"Portable Computing Language", "cpu", "9.9", TEXT_ALONE, true, false},
    {"Portable Computing Language", "gpu", "3.1", TEXT_GROUPS, true, false}, /* PoCL drives GPUs, too */
    {"Intel(R) OpenCL", "cpu", "2026.22.10.0.01_160000", TEXT_ALONE, true, true},
    {"Intel(R) OpenCL Graphics", "gpu", "24.13.29138.7", TEXT_GROUPS, true, false},
    {"rusticl", "cpu", "22.3.6", TEXT_GROUPS, false, true},
    {"rusticl", "gpu", "99.0", TEXT_GROUPS, false, false},
    {"Oclgrind", "cpu", "Oclgrind 21.10", TEXT_GROUPS, true, true},
    {"NVIDIA CUDA", "gpu", "550.54.15", TEXT_GROUPS, true, false},
    {"Somebody's OpenCL", "cpu", "1.0", TEXT_GROUPS, true, false},
    {"", "other", "", TEXT_GROUPS, true, false},
};

int main(void) {
    for (size_t n = 0; n < sizeof devices / sizeof *devices; n++) {
        const expected *e = &devices[n];
        tc_device_info device = {.struct_size = sizeof device};
        snprintf(device.platform, sizeof device.platform, "%s", e->platform);
        snprintf(device.type, sizeof device.type, "%s", e->type);
        snprintf(device.driver, sizeof device.driver, "%s", e->driver);
        const text_rule *rule = text_rule_of(&device);
        EXPECT(rule->text == e->text, "%s, %s: text %d", e->platform, e->type, (int)rule->text);
        EXPECT(rule->takes_alone == e->takes_alone, "%s, %s: the text for one work-item", e->platform, e->type);
        EXPECT(rule->takes_alone || rule->text == TEXT_GROUPS, "%s: gets what it does not take", e->platform);
        EXPECT(text_tried(&device) == e->tried, "%s, %s: tried", e->platform, e->driver);
        EXPECT(*rule->why, "%s: no reason", e->platform);
    }
    EXPECT(text_for(1) == TEXT_ALONE && text_for(32) == TEXT_GROUPS && text_for(64) == TEXT_GROUPS, "work-items");
    return EXPECT_DONE();
}
