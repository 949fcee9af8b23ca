/* devices.c - every OpenCL device, with the limits that matter here */
#include "commands.h"
#include "exit_status.h"
#include "failure.h"
#include "library_status.h"
#include "terminal/json_report.h"

#include <inttypes.h>
#include <stdio.h>

static json_t *device_json(int index, const tc_device_info *d) {
    char spec[32];
    snprintf(spec, sizeof spec, "%d:%d", d->platform_index, d->device_index);
    json_t *object = json_object();
    json_object_set_new(object, "index", json_integer(index));
    json_object_set_new(object, "spec", json_string(spec));
    json_object_set_new(object, "name", string_json(d->name));
    json_object_set_new(object, "platform", string_json(d->platform));
    json_object_set_new(object, "version", string_json(d->version));
    json_object_set_new(object, "driver", string_json(d->driver));
    json_object_set_new(object, "type", json_string(d->type));
    json_object_set_new(object, "compute_units", json_integer(d->compute_units));
    json_object_set_new(object, "max_work_group_size", json_integer((json_int_t)d->max_work_group_size));
    json_object_set_new(object, "global_memory_bytes", json_integer((json_int_t)d->global_memory_bytes));
    json_object_set_new(object, "max_buffer_bytes", json_integer((json_int_t)d->max_buffer_bytes));
    json_object_set_new(object, "local_memory_bytes", json_integer((json_int_t)d->local_memory_bytes));
    json_object_set_new(object, "shares_host_memory", json_boolean(d->shares_host_memory));
    json_object_set_new(object, "has_fp64", json_boolean(d->has_fp64));
    json_object_set_new(object, "rounds_division", json_boolean(d->rounds_division));
    return object;
}

static void device_text(int index, const tc_device_info *d) {
    const double mib = 1024.0 * 1024.0;
    printf("%d  %d:%d  %s  %s\n", index, d->platform_index, d->device_index, d->type, d->name);
    printf("   platform      %s\n", d->platform);
    printf("   version       %s, driver %s\n", d->version, d->driver);
    printf("   compute       %" PRIu32 " units, work-groups up to %" PRIu64 "\n", d->compute_units,
           d->max_work_group_size);
    printf("   memory        %.0f MiB, buffers up to %.0f MiB, local %.0f KiB%s\n",
           (double)d->global_memory_bytes / mib, (double)d->max_buffer_bytes / mib,
           (double)d->local_memory_bytes / 1024.0, d->shares_host_memory ? ", shared with the host" : "");
    printf("   arithmetic    %s; f32 division %s\n",
           d->has_fp64 ? "fp64" : "no fp64 (i32, u32, f64 vertices by the host)",
           d->rounds_division ? "rounded by the device" : "corrected in the kernels");
}

int devices_run(const options *o) {
    int count = 0;
    if (o->operand_count) return fail(STATUS_USAGE, "devices takes no '%s'", o->operands[0]);
    int status = library_status(tc_device_count(&count));
    json_t *array = o->json ? json_array() : NULL;
    for (int n = 0; n < count && !status; n++) {
        tc_device_info device = {.struct_size = sizeof device};
        status = library_status(tc_device_get(n, &device));
        if (status) break;
        if (o->json)
            json_array_append_new(array, device_json(n, &device));
        else
            device_text(n, &device);
    }
    if (o->json && !status) return json_report_print(json_pack("{s:o}", "devices", array));
    json_decref(array);
    return status;
}
