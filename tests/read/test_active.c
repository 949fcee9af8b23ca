/* test_active.c - of several fields, none of them chosen, the file's active scalars are taken */
#include "expect.h"

#include "exit_status.h"
#include "failure.h"
#include "field/select.h"
#include "folder.h"
#include "read.h"
#include "read_formats.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define LEGACY "# vtk DataFile Version 3.0\nt\nASCII\nDATASET STRUCTURED_POINTS\nDIMENSIONS 3 2 2\n"
#define POINTS "POINT_DATA 12\n"
#define CELLS  "CELL_DATA 2\n"

#define SCALARS(name) "SCALARS " name " float 1\nLOOKUP_TABLE default\n0 1 2 3 4 5 6 7 8 9 10 11\n"
#define COLOURS(name) "COLOR_SCALARS " name " 1\n0 0 0 0 0 0 1 1 1 1 1 1\n"
#define OTHER(name)   "FIELD f 1\n" name " 1 12 float\n0 1 2 3 4 5 6 7 8 9 10 11\n"
#define OF_CELLS(n)   "SCALARS " n " float 1\nLOOKUP_TABLE default\n0 1\n"
#define IDS(name)     "GLOBAL_IDS " name " int\n0 1 2 3 4 5 6 7 8 9 10 11\n"

#define XML(points, cells)                                                                                             \
    "<VTKFile type=\"ImageData\" byte_order=\"LittleEndian\"><ImageData><Piece Extent=\"0 1 0 1 0 "                    \
    "1\"><PointData" points                                                                                            \
    "><DataArray type=\"UInt8\" Name=\"a\" format=\"ascii\">1 2 3 4 5 6 7 8</DataArray><DataArray type=\"UInt8\" "     \
    "Name=\"b\" format=\"ascii\">1 2 3 4 5 6 7 8</DataArray></PointData><CellData" cells                               \
    "><DataArray type=\"UInt8\" Name=\"c\" format=\"ascii\">1</DataArray></CellData></Piece></ImageData></VTKFile>"

/* field: that is taken; NULL: one has to be chosen. is_active: because the file says so. */
static void check(const char *name, const char *text, const char *field, int is_active, int on_cells) {
    char path[600];
    read_request request;
    dataset d;
    scalar s;
    snprintf(path, sizeof path, "%s/%s", folder, name);
    FILE *file = fopen(path, "w");
    if (!file || fputs(text, file) < 0 || fclose(file)) abort();
    read_request_init(&request, path);
    int status = dataset_read(&request, &d);
    EXPECT(!status, "%s: %s", text, failure_text());
    if (status) return;
    status = scalar_select(&d, &request, &s);
    int components = 0, known = scalar_components(&d, &request, &components);
    EXPECT(field ? !status : status == STATUS_USAGE && strstr(failure_text(), "several fields"), "%s: status %d, %s",
           text, status, failure_text());
    EXPECT(!known && components == (field ? 1 : 0), "%s: %d components", text, components);
    if (!status && field)
        EXPECT(!strcmp(s.name, field) && s.is_active == is_active && s.is_averaged == on_cells, "%s: '%s', active %d",
               text, s.name, s.is_active);
    const char *active = active_field(&d);
    if (is_active) EXPECT(active && !strcmp(active, field), "%s: active is '%s'", text, active ? active : "");
    request.field = "a";
    if (!status) EXPECT(!scalar_select(&d, &request, &s) && !s.is_active && !strcmp(s.name, "a"), "%s: chosen", text);
    dataset_release(&d);
}

int main(void) {
    folder_make("active");
    check("a.vtk", LEGACY POINTS SCALARS("a"), "a", 0, 0);
    check("a.vtk", LEGACY POINTS SCALARS("a") SCALARS("b"), "a", 1, 0);
    check("a.vtk", LEGACY POINTS SCALARS("b") SCALARS("a"), "b", 1, 0);
    check("a.vtk", LEGACY POINTS OTHER("a") SCALARS("b"), "b", 1, 0);
    check("a.vtk", LEGACY POINTS OTHER("a") COLOURS("b") SCALARS("c"), "b", 1, 0);
    check("a.vtk", LEGACY POINTS IDS("a") SCALARS("b"), "b", 1, 0);
    check("a.vtk", LEGACY POINTS OTHER("a") IDS("b"), NULL, 0, 0);
    check("a.vtk", LEGACY CELLS OF_CELLS("c") POINTS SCALARS("a"), "a", 1, 0);
    check("a.vtk", LEGACY CELLS OF_CELLS("c") POINTS OTHER("a"), "c", 1, 1);
    check("a.vtk", LEGACY POINTS OTHER("a") OTHER("b") CELLS OF_CELLS("a"), "a", 1, 1);
    check("a.vtk", LEGACY POINTS SCALARS("a") CELLS OF_CELLS("c") OF_CELLS("d"), "a", 1, 0);
    char formats[FORMATS_TEXT];
    if (strstr(read_formats_text(formats), "VTK XML")) {
        check("a.vti", XML("", ""), NULL, 0, 0);
        check("a.vti", XML(" Scalars=\"b\"", ""), "b", 1, 0);
        check("a.vti", XML(" Vectors=\"b\" Scalars=\"a\"", " Scalars=\"c\""), "a", 1, 0);
        check("a.vti", XML("", " Scalars=\"c\""), "c", 1, 1);
        check("a.vti", XML(" Scalars=\"none\"", ""), NULL, 0, 0);
        check("a.vti", XML(" Scalars=\"\"", ""), NULL, 0, 0);
    }
    folder_remove();
    return EXPECT_DONE();
}
