#include "coarse.h"

#include "exit_status.h"
#include "failure.h"
#include "notice.h"
#include "report.h"

#include <float.h>
#include <math.h>

enum { EDGES_PROBED = 4096, STEPS_MOST = 256 }; /* of an edge: fewer steps lose the shape */

/* The mean of the longest edges of triangles taken evenly; 0 of none. */
static double mean_edge(const tc_mesh_data *m) {
    const uint64_t stride = m->triangle_count / EDGES_PROBED + 1;
    double sum = 0;
    uint64_t count = 0;
    for (uint64_t t = 0; t < m->triangle_count; t += stride, count++) {
        double longest = 0;
        for (uint64_t c = 0; c < 3; c++) {
            const float *a = m->positions + 3 * (uint64_t)m->triangles[3 * t + c];
            const float *b = m->positions + 3 * (uint64_t)m->triangles[3 * t + (c + 1) % 3];
            const double x = (double)b[0] - (double)a[0], y = (double)b[1] - (double)a[1];
            longest = fmax(longest, hypot(hypot(x, y), (double)b[2] - (double)a[2]));
        }
        sum += longest;
    }
    return count ? sum / (double)count : 0;
}

/* The largest coordinate, offset added. */
static double reach_of(const tc_mesh_data *m, const double offset[3]) {
    double reach = 0;
    for (uint64_t n = 0; n < 3 * m->vertex_count; n++)
        reach = fmax(reach, fabs((double)m->positions[n] + offset[n % 3]));
    return reach;
}

void coarse_tell_mesh(const tc_mesh_data *mesh, const double bounds[2][3], const typed_isovalue *iso) {
    double reach = 0;
    if (!notice_wanted() || !mesh->triangle_count) return;
    for (int axis = 0; axis < 3; axis++)
        for (int end = 0; end < 2; end++) reach = fmax(reach, fabs(bounds[end][axis] - mesh->origin[axis]));
    const double edge = mean_edge(mesh), step = reach * 0x1p-24;
    if (!(step * STEPS_MOST > edge)) return;
    notice("isovalue %s: edges of triangles are about %.2g long, and float32 has steps of %.2g where the surface lies: "
           "shapes are coarse; parts that lie far from each other are finer from files of their own",
           iso->text, edge, step);
}

int coarse_check_file(const tc_mesh_data *mesh, const double origin_at[3], int digits) {
    double offset[3];
    for (int axis = 0; axis < 3; axis++) offset[axis] = mesh->origin[axis] - origin_at[axis];
    const double reach = reach_of(mesh, offset), step = ldexp(reach, -digits), edge = mean_edge(mesh);
    if (digits < DBL_MANT_DIG && reach > FLT_MAX)
        return fail(STATUS_USAGE,
                    "--origin-at: the surface is %.3g away from that point, beyond float32, which STL holds", reach);
    if (mesh->triangle_count && step * STEPS_MOST > edge)
        notice(
            "--origin-at lies so far from the surface that the file's numbers have steps of %.2g there, and edges of "
            "triangles are %.2g long: shapes are lost; choose a point near %s,%s,%s",
            step, edge, report_number(mesh->origin[0]).text, report_number(mesh->origin[1]).text,
            report_number(mesh->origin[2]).text);
    return 0;
}
