/* pending.c - stand-ins for parts that are written elsewhere; refuses */
#include "exit_status.h"
#include "failure.h"
#include "readers.h"

struct complex_file;
int complex_write_check(const char *path);
int complex_write(const char *path, const struct complex_file *complex);

int vtk_legacy_read(const read_request *request, const mapping *file, dataset *out) {
    (void)file, (void)out;
    return fail(STATUS_INPUT, "%s: VTK legacy is not there", request->path);
}

int vtk_xml_read(const read_request *request, const mapping *file, dataset *out) {
    (void)file, (void)out;
    return fail(STATUS_INPUT, "%s: VTK XML is not there", request->path);
}

int plot3d_read(const read_request *request, const mapping *file, dataset *out) {
    (void)file, (void)out;
    return fail(STATUS_INPUT, "%s: Plot3D is not there", request->path);
}

tc_status tc_tetrahedralize(const tc_cells *cells, tc_complex *complex) {
    (void)cells, (void)complex;
    return TC_ERROR_DATA;
}

tc_status tc_tetrahedralize_grid(const tc_grid_options *grid, tc_complex *complex) {
    (void)grid, (void)complex;
    return TC_ERROR_DATA;
}

void tc_complex_release(tc_complex *complex) { (void)complex; }

void tc_complex_options_init(tc_complex_options *options) {
    *options = (tc_complex_options){.struct_size = sizeof *options};
}

tc_status tc_complex_create(tc_context *context, const tc_complex_options *options, tc_grid **grid) {
    (void)context, (void)options, (void)grid;
    return TC_ERROR_DATA;
}

tc_status tc_carry(tc_grid *grid, const tc_extract_options *options, const tc_field *field, float *out,
                   uint64_t value_count) {
    (void)grid, (void)options, (void)field, (void)out, (void)value_count;
    return TC_ERROR_DATA;
}

int complex_write_check(const char *path) {
    (void)path;
    return 0;
}

int complex_write(const char *path, const struct complex_file *complex) {
    (void)complex;
    return fail(STATUS_FAILED, "%s: .vtu is not there", path);
}
