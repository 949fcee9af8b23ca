#include "labels/label_cells.h"

#include "exit_status.h"
#include "failure.h"
#include "field/select.h"
#include "terminal/notice.h"

static double *midpoints(dataset *d, coordinates axis, int64_t count) {
    double *values = dataset_allocate(d, (uint64_t)count * sizeof *values);
    for (int64_t n = 0; values && n < count; n++) values[n] = (coordinate_at(axis, n) + coordinate_at(axis, n + 1)) / 2;
    return values;
}

static double *centres(dataset *d, const dataset_block *b) {
    const int64_t *dims = b->dims;
    double *values = dataset_allocate(d, 3 * (uint64_t)b->cell_count * sizeof *values), *to = values;
    for (int64_t k = 0; values && k + 1 < dims[2]; k++)
        for (int64_t j = 0; j + 1 < dims[1]; j++)
            for (int64_t i = 0; i + 1 < dims[0]; i++)
                for (int axis = 0; axis < 3; axis++) {
                    double sum = 0;
                    for (int c = 0; c < 8; c++) {
                        const int64_t point = ((k + (c >> 2)) * dims[1] + j + (c >> 1 & 1)) * dims[0] + i + (c & 1);
                        sum += coordinate_at(b->points, 3 * point + axis);
                    }
                    *to++ = sum / 8;
                }
    return values;
}

static int geometry_move(dataset *d, dataset_block *b) {
    for (int row = 0; row < 3; row++) {
        double *m = b->matrix[row];
        m[3] += (m[0] + m[1] + m[2]) / 2;
    }
    for (int axis = 0; axis < 3 && b->kind == BLOCK_RECTILINEAR; axis++) {
        b->axes[axis] = (coordinates){.f64 = midpoints(d, b->axes[axis], b->dims[axis] - 1)};
        if (!b->axes[axis].f64) return STATUS_FAILED;
    }
    if (b->kind == BLOCK_CURVILINEAR) {
        b->points = (coordinates){.f64 = centres(d, b)};
        if (!b->points.f64) return STATUS_FAILED;
    }
    return 0;
}

static void cells_become_points(dataset_block *b) {
    int count = 0;
    for (int n = 0; n < b->field_count; n++) {
        if (!b->fields[n].on_cells) continue;
        b->fields[count] = b->fields[n];
        b->fields[count++].on_cells = 0;
    }
    b->field_count = count;
    b->blanked_points = b->blanked_cells;
    b->blanked_cells = NULL;
    b->point_count = b->cell_count;
    b->cell_count = 1;
    for (int axis = 0; axis < 3; axis++) b->cell_count *= --b->dims[axis] - 1;
}

int label_cells_take(const read_request *request, dataset *d) {
    dataset_block *b = d->blocks;
    const dataset_field *f;
    int status = scalar_field(d, request, &f);
    if (status || !f || !f->on_cells) return status;
    if (b->whole)
        return fail(STATUS_USAGE,
                    "%s: its labels belong to cells, of which no part is read: leave out --roi, "
                    "--roi-world and --step",
                    request->path);
    for (int axis = 0; axis < 3; axis++)
        if (b->dims[axis] < 2)
            return fail(STATUS_INPUT, "%s: its cells are flat, and label maps are solid", request->path);
    notice("%s: labels belong to cells: samples are their centres", request->path);
    status = geometry_move(d, b);
    if (!status) cells_become_points(b);
    return status;
}
