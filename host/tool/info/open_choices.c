/* open_choices.c - what an input leaves open; see open_choices.h */
#include "open_choices.h"

#include "exit_status.h"
#include "field/select.h"
#include "terminal/json_report.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>

int open_choices_find(const read_request *request, const dataset *d, open_choices *c) {
    int components = 0, status = scalar_components(d, request, &components);
    *c = (open_choices){.meaning = d->frames && d->blocks->fields->meaning ? d->blocks->fields->meaning : ""};
    if (status) return status;
    if (d->frames > 1) c->frames = d->frames;
    if (components > 1 && request->component == COMPONENT_OPEN) c->components = components;
    c->can_select = components && !c->components;
    c->taken = request->field ? NULL : active_field(d);
    if (components && !c->taken) return 0;
    c->field_count = common_field_names(d, &c->fields);
    return c->field_count < 0 ? STATUS_FAILED : 0;
}

void open_choices_release(open_choices *c) {
    free(c->fields);
    *c = (open_choices){0};
}

json_t *open_choices_json(const open_choices *c) {
    json_t *array = json_array(), *names = json_array();
    for (int n = 0; n < c->field_count; n++) json_array_append_new(names, string_json(c->fields[n]));
    if (c->field_count > 1) {
        json_t *fields = json_pack("{s:s, s:O}", "option", "--field", "names", names);
        if (c->taken) json_object_set_new(fields, "taken", string_json(c->taken));
        json_array_append_new(array, fields);
    }
    if (c->components)
        json_array_append_new(array, json_pack("{s:s, s:i, s:s}", "option", "--component", "count", c->components,
                                               "meaning", c->meaning));
    if (c->frames)
        json_array_append_new(array, json_pack("{s:s, s:I}", "option", "--frame", "count", (json_int_t)c->frames));
    json_decref(names);
    return array;
}

void open_choices_text(const open_choices *c) {
    if (c->field_count > 1)
        printf("choose        a field by --field NAME, of those with several components one by --component C, or "
               "their length by --component magnitude%s%s%s\n",
               c->taken ? "; without it '" : "", c->taken ? c->taken : "", c->taken ? "' is taken" : "");
    if (c->components)
        printf("choose        one of %d values per sample%s%s%s by --component 0 to %d, or their length by --component "
               "magnitude\n",
               c->components, *c->meaning ? " (" : "", c->meaning, *c->meaning ? ")" : "", c->components - 1);
    if (c->frames)
        printf("choose        one of %" PRId64 " frames by --frame 0 to %" PRId64 "; ranges here are of frame 0\n",
               c->frames, c->frames - 1);
}
