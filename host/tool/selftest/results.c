#include "results.h"

#include "exit_status.h"
#include "failure.h"
#include "output.h"
#include "trials.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

void results_add(selftest_results *all, int group, const char *name, trial_end end, const char *text, double ms) {
    if (all->count == all->capacity) {
        size_t capacity = all->capacity ? 2 * all->capacity : 64;
        trial_result *grown = realloc(all->results, capacity * sizeof *grown);
        if (!grown) {
            all->out_of_memory = 1;
            return;
        }
        all->results = grown;
        all->capacity = capacity;
    }
    trial_result *r = &all->results[all->count];
    *r = (trial_result){group, strdup(name), strdup(text), end, ms};
    if (r->name && r->text) {
        all->count++;
        return;
    }
    free(r->name);
    free(r->text);
    all->out_of_memory = 1;
}

void results_release(selftest_results *all) {
    for (size_t n = 0; n < all->count; n++) {
        free(all->results[n].name);
        free(all->results[n].text);
    }
    free(all->results);
    *all = (selftest_results){0};
}

/* ------------------------------------------------------------------------------------------------------------ JUnit */

/* Text between the marks of XML; what XML cannot hold becomes ?. */
static void escape(FILE *out, const char *text) {
    for (; *text; text++) switch (*text) {
        case '<':
            fputs("&lt;", out);
            break;
        case '>':
            fputs("&gt;", out);
            break;
        case '&':
            fputs("&amp;", out);
            break;
        case '"':
            fputs("&quot;", out);
            break;
        default:
            fputc((unsigned char)*text < ' ' || (unsigned char)*text > '~' ? '?' : *text, out);
        }
}

static void attribute(FILE *out, const char *name, const char *text) {
    fprintf(out, " %s=\"", name);
    escape(out, text);
    fputc('"', out);
}

typedef struct tally {
    int tests, failures, errors, skipped;
    double seconds;
} tally;

/* Of one group, or of all where group is below VECTORS. */
static tally count(const selftest_results *all, int group) {
    tally t = {0};
    for (size_t n = 0; n < all->count; n++) {
        const trial_result *r = &all->results[n];
        if (group >= VECTORS && r->group != group) continue;
        t.tests++;
        t.failures += r->end == TRIAL_FAILED;
        t.errors += r->end == TRIAL_CRASHED || r->end == TRIAL_HUNG || r->end == TRIAL_LATE;
        t.skipped += r->end == TRIAL_SKIPPED;
        t.seconds += 1e-3 * r->ms;
    }
    return t;
}

static void tally_print(FILE *out, const char *element, const char *name, tally t) {
    fprintf(out, "<%s", element);
    attribute(out, "name", name);
    fprintf(out, " tests=\"%d\" failures=\"%d\" errors=\"%d\" skipped=\"%d\" time=\"%.3f\">\n", t.tests, t.failures,
            t.errors, t.skipped, t.seconds);
}

static void case_print(FILE *out, const trial_result *r) {
    static const char *const elements[] = {[TRIAL_FAILED] = "failure",
                                           [TRIAL_CRASHED] = "error",
                                           [TRIAL_HUNG] = "error",
                                           [TRIAL_LATE] = "error",
                                           [TRIAL_SKIPPED] = "skipped"};
    static const char *const types[] = {[TRIAL_FAILED] = "wrong",
                                        [TRIAL_CRASHED] = "crashed",
                                        [TRIAL_HUNG] = "hung",
                                        [TRIAL_LATE] = "late",
                                        [TRIAL_SKIPPED] = ""};
    char class[64];
    snprintf(class, sizeof class, "tetracubes.%s", group_name(r->group));
    fprintf(out, "    <testcase");
    attribute(out, "classname", class);
    attribute(out, "name", r->name);
    fprintf(out, " time=\"%.3f\"", 1e-3 * r->ms);
    if (r->end == TRIAL_OK) {
        fprintf(out, "/>\n");
        return;
    }
    fprintf(out, "><%s", elements[r->end]);
    if (*types[r->end]) attribute(out, "type", types[r->end]);
    attribute(out, "message", r->text);
    fprintf(out, "/></testcase>\n");
}

static void suite_print(FILE *out, const selftest_results *all, int group, const tc_device_info *device) {
    tally t = count(all, group);
    if (!t.tests) return;
    fprintf(out, "  ");
    tally_print(out, "testsuite", group_name(group), t);
    const struct {
        const char *name, *value;
    } properties[] = {{"device", device->name},
                      {"platform", device->platform},
                      {"driver", device->driver},
                      {"version", device->version},
                      {"tetracubes", tc_version()}};
    fprintf(out, "    <properties>\n");
    for (size_t n = 0; n < sizeof properties / sizeof *properties; n++) {
        fprintf(out, "      <property");
        attribute(out, "name", properties[n].name);
        attribute(out, "value", properties[n].value);
        fprintf(out, "/>\n");
    }
    fprintf(out, "    </properties>\n");
    for (size_t n = 0; n < all->count; n++)
        if (all->results[n].group == group) case_print(out, &all->results[n]);
    fprintf(out, "  </testsuite>\n");
}

int junit_write(const char *path, const selftest_results *all, const tc_device_info *device) {
    char *text = NULL;
    size_t bytes = 0;
    output file;
    FILE *out = open_memstream(&text, &bytes);
    if (!out) return fail(STATUS_FAILED, "out of memory for %s", path);
    fprintf(out, "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n");
    tally_print(out, "testsuites", "tetracubes selftest", count(all, VECTORS - 1));
    for (int group = VECTORS; group < trial_group_count; group++) suite_print(out, all, group, device);
    fprintf(out, "</testsuites>\n");
    int failed = ferror(out);
    failed |= fclose(out);
    int status = failed || all->out_of_memory ? fail(STATUS_FAILED, "out of memory for %s", path) : 0;
    if (!status) status = output_open(&file, path);
    if (!status) {
        output_bytes(&file, text, bytes);
        status = output_close(&file);
    }
    free(text);
    return status;
}
