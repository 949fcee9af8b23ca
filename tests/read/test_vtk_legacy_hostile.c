/* test_vtk_legacy_hostile.c - VTK legacy files that are damaged: what is said of each */
#include "vtk_legacy_files.h"

static const struct {
    const char *text, *part;
} damaged[] = {
    {"", "does not begin"},
    {"# vtk DataFile Version", "version"},
    {"# vtk DataFile Version x\n", "version"},
    {"# vtk DataFile Version 3.0\nt\nTEXT\n", "'TEXT' where ASCII"},
    {HEAD, "cut"},
    {HEAD "FIELD f 0\n", "no grid"},
    {HEAD "DATASET POLYDATA\n", "a surface, POLYDATA"},
    {HEAD "DATASET TABLE\n", "holds TABLE"},
    {HEAD "DATASET STRUCTURED_POINTS\n", "no DIMENSIONS"},
    {HEAD "DATASET STRUCTURED_POINTS\nDIMENSIONS 2 0 2\n", "'0' for DIMENSIONS"},
    {HEAD "DATASET STRUCTURED_POINTS\nDIMENSIONS 2 -2 2\n", "'-2' for DIMENSIONS"},
    {HEAD "DATASET STRUCTURED_POINTS\nDIMENSIONS 2 2\n", "cut"},
    {HEAD "DATASET STRUCTURED_POINTS\nEXTENT 0 1 2 1 0 0\n", "'1' for EXTENT"},
    {HEAD "DATASET STRUCTURED_POINTS\nDIMENSIONS 2147483647 2147483647 2147483647\n", "2^63"},
    {IMAGE "DIMENSIONS 2 2 2\n", "twice"},
    {IMAGE "SPACING 1 1 0\n", "spacing"},
    {IMAGE "SPACING 1 x 1\n", "'x' for SPACING"},
    {IMAGE "POINTS 4 float\n", "'POINTS' where a keyword"},
    {IMAGE "SCALARS s float\n", "before POINT_DATA"},
    {IMAGE "POINT_DATA 5\n", "POINT_DATA of 5, but 4 points"},
    {IMAGE "POINT_DATA 99999999999999999999\n", "integer"},
    {IMAGE "CELL_DATA 2\n", "CELL_DATA of 2, but 1 cells"},
    {IMAGE "POINT_DATA 4\nDIMENSIONS 2 2 2\n", "behind the first POINT_DATA"},
    {IMAGE "POINT_DATA 4\nSCALARS s float\nLOOKUP_TABLE default\n1 2 3", "too few"},
    {IMAGE "POINT_DATA 4\nSCALARS s float\nLOOKUP_TABLE default\n1 2 3          ",
     "ends within the values of array 's'"},
    {IMAGE "POINT_DATA 4\nSCALARS s float\nLOOKUP_TABLE default\n1 2 x 4", "'x' among the values of array 's'"},
    {IMAGE "POINT_DATA 4\nSCALARS s float\nLOOKUP_TABLE default\n1 2 3 4 5", "'5' where a keyword"},
    {IMAGE "POINT_DATA 4\nSCALARS s char\nLOOKUP_TABLE default\n1 2 3 128", "'128'"},
    {IMAGE "POINT_DATA 4\nSCALARS s unsigned_char\nLOOKUP_TABLE default\n1 2 3 -1", "'-1'"},
    {IMAGE "POINT_DATA 4\nSCALARS s int\nLOOKUP_TABLE default\n1 2 3 1.5", "'1.5'"},
    {IMAGE "POINT_DATA 4\nSCALARS s quad\nLOOKUP_TABLE default\n1 2 3 1.5", "'quad'"},
    {IMAGE "POINT_DATA 4\nSCALARS s float 2147483647\nLOOKUP_TABLE default\n1 2 3 1.5", "too few"},
    {IMAGE "POINT_DATA 4\nSCALARS s float 0\nLOOKUP_TABLE default\n1 2 3 1.5", "components"},
    {IMAGE "POINT_DATA 4\nTEXTURE_COORDINATES t 4 float\n", "'4' for the dimension"},
    {IMAGE "POINT_DATA 4\nFIELD f 1\na 1 5 float\n1 2 3 4 5\n", "5 tuples in array 'a' for 4 points"},
    {IMAGE "POINT_DATA 4\nFIELD f -1\n", "'-1'"},
    {IMAGE "POINT_DATA 4\nFIELD f 9\n", "cut"},
    {IMAGE "FIELD f 1\na 2147483647 576460752303423487 double\n", "too few"},
    {IMAGE "FIELD f 1\na 4 1000000000000 string\nx\n", "too few"},
    {IMAGE "FIELD f 1\na 1 3 string\nx\n   ", "ends within the texts"},
    {IMAGE "POINT_DATA 4\nLOOKUP_TABLE t 2147483647\n", "too few"},
    {IMAGE_B "POINT_DATA 4\nSCALARS s double\nLOOKUP_TABLE default\n12345678123456781234567812345678"
             "SCALARS s double\nLOOKUP_TABLE default\n1234567812345678123456781234567",
     "31 bytes that follow"},
    {IMAGE_B "FIELD f 1\na 1 2 string\n\xC1x\xC5xyz", "ends within the texts"},
    {IMAGE_B "FIELD f 1\na 1 1 string\n\x3F\xFF\xFF\xFF\xFF\xFF\xFF\xFFx", "ends within the texts"},
    {HEAD "DATASET RECTILINEAR_GRID\nDIMENSIONS 2 2 1\nX_COORDINATES 3 float\n1 2 3\n", "3 coordinates along axis 1"},
    {HEAD "DATASET RECTILINEAR_GRID\nDIMENSIONS 2 2 1\nX_COORDINATES 2 float\n1 nan\n", "not finite"},
    {HEAD "DATASET RECTILINEAR_GRID\nDIMENSIONS 2 2 1\nX_COORDINATES 2 double\n1 1e399\n", "not finite"},
    {HEAD "DATASET RECTILINEAR_GRID\nDIMENSIONS 2 2 1\nX_COORDINATES 2 string\nx\ny\n", "texts for X_COORDINATES"},
    {HEAD "DATASET STRUCTURED_GRID\nDIMENSIONS 2 1 1\n", "0 POINTS, but DIMENSIONS of 2"},
    {HEAD "DATASET STRUCTURED_GRID\nDIMENSIONS 2 1 1\nPOINTS 3 float\n0 0 0 0 0 0 0 0 0\n", "3 POINTS"},
    {CURVED("2.0", "BLANKING 3 unsigned_char\n1 0 1\n"), "BLANKING of 3"},
    {CURVED("2.0", "BLANKING 4 float\n1 0 1 1\n"), "neither"},
    {UNSTRUCTURED("300000000000000000 double\n1 2 3\n"), "'300000000000000000'"},
    {UNSTRUCTURED("100000000000000000 double\n1 2 3\n"), "too few"},
    {HEAD "DATASET UNSTRUCTURED_GRID\n", "no POINTS"},
#define FOUR UNSTRUCTURED("4 float\n0 0 0 1 0 0 0 1 0 0 0 1\n")
    {FOUR "CELLS 1 5\n4 0 1 2 4\nCELL_TYPES 1\n10\n", "cell 0 with point 4, but points 0 to 3"},
    {FOUR "CELLS 1 5\n4 0 1 -1 3\nCELL_TYPES 1\n10\n", "point -1"},
    {FOUR "CELLS 1 5\n4 0 1 2 3\n", "CELL_TYPES for 0"},
    {FOUR "CELL_TYPES 1\n10\n", "0 cells, but CELL_TYPES for 1"},
    {FOUR "CELLS 1 5\n4 0 1 2 3\nCELL_TYPES 1\n256\n", "0 to 255"},
    {FOUR "CELLS 1 5\n5 0 1 2 3\nCELL_TYPES 1\n10\n", "more points"},
    {FOUR "CELLS 1 5\n-1 0 1 2 3\nCELL_TYPES 1\n10\n", "fewer than 0"},
    {FOUR "CELLS 1 5\n3 0 1 2 3\nCELL_TYPES 1\n10\n", "take 4 numbers, but says 5"},
    {FOUR "CELLS 2 1\n0\n", "at least one"},
    {FOUR "CELLS 100000000000000000 100000000000000000\n0\n", "too few"},
    {FOUR "CELLS 2 4\nOFFSETS vtktypeint64\n0 5\nCONNECTIVITY vtktypeint64\n0 1 2 3\nCELL_TYPES 1\n10\n", "lead out"},
    {FOUR "CELLS 3 4\nOFFSETS int\n0 4 3\nCONNECTIVITY int\n0 1 2 3\nCELL_TYPES 2\n10 10\n", "do not rise"},
    {FOUR "CELLS 2 4\nOFFSETS int\n1 4\nCONNECTIVITY int\n0 1 2 3\nCELL_TYPES 1\n10\n", "from 1 to 4"},
    {FOUR "CELLS 2 4\nOFFSETS int\n0 3\nCONNECTIVITY int\n0 1 2 3\nCELL_TYPES 1\n10\n", "from 0 to 3"},
    {FOUR "CELLS 2 4\nOFFSETS int\n0 4\nCELL_TYPES 1\n10\n", "no CONNECTIVITY"},
    {FOUR "CELLS 2 4\nOFFSETS float\n0 4\n", "no integers"},
    {FOUR "CELLS 2 4\nOFFSETS vtktypeuint64\n0 9223372036854775808\n", "beyond 2^63"},
};

static void test_damaged(void) {
    for (size_t i = 0; i < sizeof damaged / sizeof *damaged; i++) {
        dataset d;
        const char *path = file_text("damaged.vtk", damaged[i].text);
        int status = read_path(path, &d);
        EXPECT(status == STATUS_INPUT, "%s\nstatus %d: %s", damaged[i].text, status, failure_text());
        if (!status) dataset_release(&d);
        EXPECT(strstr(failure_text(), path) && strstr(failure_text(), damaged[i].part), "no '%s': %s", damaged[i].part,
               failure_text());
    }
    bytes b = {0};
    bytes_text(&b, IMAGE "POINT_DATA 4\n");
    for (int i = 0; i < 300; i++) bytes_text(&b, "x");
    dataset d;
    EXPECT(read_bytes("x", b.data, b.size, &d) == STATUS_INPUT && strstr(failure_text(), "longer than 255"), "%s",
           failure_text());
    b.size -= 300;
    bytes_text(&b, "FIELD f 5000\n");
    for (int i = 0; i < 5000; i++) bytes_text(&b, "a 1 4 char\n1 2 3 4\n");
    EXPECT(read_bytes("x", b.data, b.size, &d) == STATUS_INPUT && strstr(failure_text(), "4096 arrays"), "%s",
           failure_text());
    bytes_free(&b);
}

int main(void) {
    folder_make("vtk-legacy-hostile");
    test_damaged();
    folder_remove();
    return EXPECT_DONE();
}
