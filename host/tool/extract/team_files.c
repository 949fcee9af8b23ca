#include "team_files.h"

#include "exit_status.h"

#include <math.h>
#include <string.h>

void team_surfaces_count(team *t, surface_report *reports, team_surface *surfaces, size_t count) {
    for (size_t n = 0; n < count; n++) {
        surface_report *s = &reports[n];
        uint64_t values[3] = {s->vertex_count, s->triangle_count, s->active_cell_count}, before[3];
        t->sum(t, values, before, 3);
        const int is_first = !before[0] && !before[1] && (s->vertex_count || s->triangle_count);
        const int is_empty = !values[0] && !values[1];
        surfaces[n].first_vertex = before[0];
        surfaces[n].first_triangle = before[1];
        surfaces[n].shared.writes_frame = is_empty ? t->rank == 0 : is_first;
        s->vertex_count = values[0];
        s->triangle_count = values[1];
        s->active_cell_count = values[2];
    }
}

int team_surface_open(team *t, const char *path, team_surface *s) {
    int status = path ? 0 : STATUS_FAILED;
    if (!status && !t->rank) status = output_open(&s->whole, path);
    const int is_mine = !t->rank && !status;
    status = t->agree(t, status);
    if (!status) status = t->open(t, is_mine ? s->whole.temporary : NULL, &s->shared);
    s->is_open = !status;
    if (status && is_mine) output_discard(&s->whole);
    return status;
}

int team_surfaces_close(team *t, team_surface *surfaces, size_t count, output_group *group) {
    int status = 0;
    for (size_t n = 0; n < count; n++) {
        team_surface *s = &surfaces[n];
        if (!s->is_open) continue;
        const int closed = t->close(t, &s->shared);
        if (!status) status = closed;
        if (t->rank) continue;
        if (status)
            output_discard(&s->whole);
        else
            status = output_wait(&s->whole, group);
    }
    return t->agree(t, status);
}

void team_surfaces_discard(const team *t, team_surface *surfaces, size_t count) {
    for (size_t n = 0; n < count; n++)
        if (surfaces[n].is_open && !t->rank) output_discard(&surfaces[n].whole);
}

void team_surfaces_report(team *t, surface_report *reports, size_t count) {
    for (size_t n = 0; n < count; n++) {
        surface_report *s = &reports[n];
        double most[13] = {s->classify_ms, s->emit_ms, s->readback_ms, s->write_ms};
        uint64_t pieces[2] = {s->piece_count, s->summary.nonfinite_vertices}, before[2];
        for (int axis = 0; axis < 3; axis++) {
            most[4 + axis] = -s->summary.bounds[0][axis];
            most[7 + axis] = s->summary.bounds[1][axis];
            most[10 + axis] = s->piece_count ? s->origin[axis] : -INFINITY; /* those that have pieces know it */
        }
        t->most(t, most, 13);
        t->sum(t, pieces, before, 2);
        s->classify_ms = most[0];
        s->emit_ms = most[1];
        s->readback_ms = most[2];
        s->write_ms = most[3];
        s->piece_count = pieces[0];
        s->summary.nonfinite_vertices = pieces[1];
        for (int axis = 0; axis < 3; axis++) {
            s->summary.bounds[0][axis] = -most[4 + axis];
            s->summary.bounds[1][axis] = most[7 + axis];
            s->origin[axis] = isfinite(most[10 + axis]) ? most[10 + axis] : 0;
        }
        s->has_origin = 1;
    }
}
