#include "reference/carry_vertex.h"

void carry_vertex(const carry *c, uint64_t vertex, int64_t a, int64_t b, float t) {
    const int components = c->field->components;
    if (vertex >= c->capacity) return;
    for (int n = 0; n < components; n++) {
        double from = value_at(c->field->type, c->field->values, (uint64_t)(a * components + n));
        double to = value_at(c->field->type, c->field->values, (uint64_t)(b * components + n));
        double value = t == 1 ? to : from + (double)t * (to - from);
        c->out[vertex * (uint64_t)components + (uint64_t)n] = (float)(t == 0 ? from : value);
    }
}
