/*
 * limit_cases.h - small files of every text format with sizes that overflow and distances that are none
 *
 * test_limits.c says what readers do with them; the fuzzers start from them.
 */
#ifndef LIMIT_CASES_H
#define LIMIT_CASES_H

#include <stddef.h>

typedef struct limit_case {
    const char *name, *text, *part; /* part: of the failure's text; NULL: the file is read */
} limit_case;

#define META     "NDims = 3\nElementType = MET_DOUBLE\n"
#define LOCAL    "ElementDataFile = LOCAL\n12345678"
#define LEGACY   "# vtk DataFile Version 3.0\ntitle\nBINARY\nDATASET "
#define POINTS4  LEGACY "UNSTRUCTURED_GRID\nPOINTS 0 float\n"
#define IMAGE    LEGACY "STRUCTURED_POINTS\nDIMENSIONS 2 2 2\n"
#define XML(t)   "<VTKFile type=\"" t "\" version=\"1.0\" byte_order=\"LittleEndian\">"
#define BLANKS64 "                                                                "
#define NPY288   "\x93NUMPY\1 \40\1" /* 288 bytes of header follow */
#define HUGE     "9223372036854775807"

static const limit_case size_cases[] = {
    {"a.mha", META "DimSize = 4294967296 4294967296 4294967296\n" LOCAL, "2^64"},
    {"a.mha", META "DimSize = 4294967296 1073741824 1\n" LOCAL, "2^60"},
    {"a.mha", META "DimSize = 4194304 4194304 4194304\nElementNumberOfChannels = 2147483647\n" LOCAL, "2^64"},
    {"a.mha", META "DimSize = " HUGE " 1 1\n" LOCAL, "2^53"},
    {"a.mha", META "DimSize = 2 2 2\nHeaderSize = " HUGE "\n" LOCAL, "behind"},
    {"a.nrrd", "NRRD0004\ntype: double\ndimension: 3\nencoding: raw\nendian: little\nsizes: " HUGE " " HUGE " 1\n\n",
     "2^64"},
    {"a.nrrd", "NRRD0004\ntype: uchar\ndimension: 3\nencoding: raw\nline skip: " HUGE "\nsizes: 2 2 2\n\n12345678",
     "lines"},
    {"a.vtk", LEGACY "STRUCTURED_POINTS\nDIMENSIONS 2147483647 2147483647 2147483647\n", "DIMENSIONS"},
    {"a.vtk", LEGACY "STRUCTURED_GRID\nDIMENSIONS 2147483647 2147483647 2\nPOINTS 9223372028264841218 float\n",
     "POINTS"},
    {"a.vtk", LEGACY "UNSTRUCTURED_GRID\nPOINTS " HUGE " float\n", "POINTS"},
    {"a.vtk", LEGACY "UNSTRUCTURED_GRID\nPOINTS 144115188075855871 float\n", "POINTS"},
    {"a.vtk", POINTS4 "CELLS 576460752303423487 576460752303423487\n", "CELLS"},
    {"a.vtk", POINTS4 "CELLS 1 " HUGE "\n", "CELLS"},
    {"a.vtk", POINTS4 "CELL_TYPES 576460752303423487\n", "CELL_TYPES"},
    {"a.vtk", IMAGE "POINT_DATA 8\nSCALARS a double 2147483647\nLOOKUP_TABLE default\n", "'a'"},
    {"a.vtk", IMAGE "POINT_DATA 8\nFIELD f 1\na 2147483647 576460752303423487 double\n", "'a'"},
    {"a.vtk", IMAGE "POINT_DATA 8\nFIELD f 2147483647\n", "name of an array"},
    {"a.vtk", IMAGE "POINT_DATA 8\nLOOKUP_TABLE a 2147483647\n", "LOOKUP_TABLE"},
    {"a.vtu",
     XML("UnstructuredGrid") "<UnstructuredGrid><Piece NumberOfPoints=\"" HUGE
                             "\" NumberOfCells=\"0\"></Piece></UnstructuredGrid></VTKFile>",
     "NumberOfPoints"},
    {"a.vtu",
     XML("UnstructuredGrid") "<UnstructuredGrid><Piece NumberOfPoints=\"1\" NumberOfCells=\"" HUGE
                             "\"></Piece></UnstructuredGrid></VTKFile>",
     "NumberOfCells"},
    {"a.vtu",
     XML("UnstructuredGrid") "<UnstructuredGrid><Piece NumberOfPoints=\"100000000000000000\" NumberOfCells=\"0\">"
                             "<Points><DataArray type=\"Float64\" NumberOfComponents=\"3\" format=\"ascii\">1"
                             "</DataArray></Points></Piece></UnstructuredGrid></VTKFile>",
     "Points"},
    {"a.vti",
     XML("ImageData") "<ImageData><Piece Extent=\"0 1 0 1 0 1\"><PointData><DataArray type=\"Float64\" Name=\"a\" "
                      "NumberOfComponents=\"2147483647\" format=\"ascii\">1</DataArray></PointData></Piece>"
                      "</ImageData></VTKFile>",
     "'a'"},
    {"a.vti",
     XML("ImageData") "<ImageData><Piece Extent=\"0 1 0 1 0 1\"><PointData><DataArray type=\"Float64\" Name=\"a\" "
                      "format=\"appended\" offset=\"" HUGE "\"/></PointData></Piece></ImageData>"
                      "<AppendedData encoding=\"raw\">_1234</AppendedData></VTKFile>",
     "'a'"},
    {"a.pvti",
     XML("PImageData") "<PImageData WholeExtent=\"0 2147483647 0 2147483647 0 2147483647\"><Piece Extent=\"0 1 0 1 0 "
                       "1\" "
                       "Source=\"whole.vti\"/></PImageData></VTKFile>",
     "leave a gap"},
    {"a.pvti",
     XML("PImageData") "<PImageData WholeExtent=\"0 2147483647 0 2147483647 0 2147483647\"><Piece Extent=\"0 "
                       "2147483647 "
                       "0 2147483647 0 2147483647\" Source=\"whole.vti\"/></PImageData></VTKFile>",
     "has the points 0 to 1 along x"},
    {"a.pvti",
     XML("PImageData") "<PImageData WholeExtent=\"0 " HUGE " 0 1 0 1\"><Piece Extent=\"0 1 0 1 0 1\" "
                       "Source=\"whole.vti\"/></PImageData></VTKFile>",
     "WholeExtent"},
    {"a.pvti",
     XML("PImageData") "<PImageData WholeExtent=\"0 1 0 1 0 1\" GhostLevel=\"2147483648\"><Piece Extent=\"0 1 0 1 0 "
                       "1\" "
                       "Source=\"whole.vti\"/></PImageData></VTKFile>",
     "GhostLevel"},
    {"a.npy",
     NPY288 "{'descr':'<f8','fortran_order':True,'shape':(" HUGE "," HUGE ",2)}" BLANKS64 BLANKS64 BLANKS64 "        ",
     "2^64"},
    {"a.xyz", "2147483647 2147483647 2147483647\n1 2 3\n", "numbers"},
    {"a.xyz", "2 2 2\n9999999999*1\n", "repeat counts"},
};

#define NRRD8(fields) "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 2 2 2\nencoding: raw\n" fields "\n\n12345678"
#define META8(fields)                                                                                                  \
    "NDims = 3\nDimSize = 2 2 2\nElementType = MET_UCHAR\n" fields "\nElementDataFile = LOCAL\n12345678"
#define LEGACY8(fields)                                                                                                \
    "# vtk DataFile Version 3.0\nt\nASCII\nDATASET STRUCTURED_POINTS\nDIMENSIONS 2 2 2\n" fields                       \
    "\nPOINT_DATA 8\nSCALARS a float\nLOOKUP_TABLE default\n1 2 3 4 5 6 7 8\n"
#define XML8(attributes)                                                                                               \
    XML("ImageData")                                                                                                   \
    "<ImageData " attributes "><Piece Extent=\"0 1 0 1 0 1\"><PointData><DataArray "                                   \
    "type=\"UInt8\" Name=\"a\" format=\"ascii\">1 2 3 4 5 6 7 8</DataArray></PointData></Piece>"                       \
    "</ImageData></VTKFile>"

static const limit_case distance_cases[] = {
    {"a.nrrd", NRRD8("spacings: 1 -2 1"), NULL}, /* mirrored */
    {"a.nrrd", NRRD8("spacings: 1 -inf 1"), "spacing along axis 2"},
    {"a.nrrd", NRRD8("spacings: 1e200 1e200 1e200"), "determinant"},
    {"a.nrrd", NRRD8("spacings: 1e-200 1e-200 1e-200"), "determinant"},
    {"a.nrrd", NRRD8("axis mins: 0 nan 0\naxis maxs: 1 1 1"), NULL}, /* not known */
    {"a.nrrd", NRRD8("spacings: 1 nan 1"), NULL},
    {"a.nrrd", NRRD8("axis mins: 0 inf 0"), "origin"},
    {"a.nrrd", NRRD8("axis mins: 0 1 0\naxis maxs: 1 1 1"), "axis 2"},
    {"a.nrrd", NRRD8("space dimension: 3\nspace directions: (-1,0,0) (0,-1,0) (0,0,-1)\nspace origin: (inf,0,0)"),
     "origin"},
    {"a.nrrd", NRRD8("space dimension: 3\nspace directions: (-1,0,0) (0,-1,0) (0,0,-1)"), NULL},
    {"a.mha", META8("ElementSpacing = 1 -1 1"), NULL},
    {"a.mha", META8("ElementSpacing = 1 0 1"), "axis 2"},
    {"a.mha", META8("ElementSpacing = inf 1 1"), "axis 1"},
    {"a.mha", META8("Offset = nan 0 0"), "finite"},
    {"a.mha", META8("TransformMatrix = nan 0 0 0 1 0 0 0 1"), "finite"},
    {"a.mha", META8("TransformMatrix = -1 0 0 0 -1 0 0 0 -1"), NULL},
    {"a.mha", META8("TransformMatrix = 1e200 0 0 0 1e200 0 0 0 1e200"), "determinant"},
    {"a.vtk", LEGACY8("SPACING 1 -1 1"), NULL},
    {"a.vtk", LEGACY8("SPACING 1 nan 1"), "finite"},
    {"a.vtk", LEGACY8("SPACING inf 1 1"), "finite"},
    {"a.vtk", LEGACY8("ORIGIN 0 0 -inf"), "finite"},
    {"a.vti", XML8("Spacing=\"1 -1 1\""), NULL},
    {"a.vti", XML8("Spacing=\"1 nan 1\""), "finite"},
    {"a.vti", XML8("Spacing=\"1 inf 1\""), "finite"},
    {"a.vti", XML8("Origin=\"0 0 inf\""), "finite"},
    {"a.vti", XML8("Direction=\"1 0 0 0 nan 0 0 0 1\""), "finite"},
    {"a.vti", XML8("Direction=\"1 0 0 0 0 0 0 0 1\""), "only zeros for axis 2"},
};

#endif
