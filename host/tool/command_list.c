/* command_list.c - the table of commands, which dispatch, --help, completion and manual pages are made of */
#include "command_list.h"

#include "commands.h"

#include <string.h>

const command command_list[] = {
    {"extract", COMMAND_EXTRACT, extract_run, NULL, "isosurface of a grid, as a triangle mesh",
     "tetracubes extract INPUT... --iso V[,V...] [-o FILE] [options]",
     "Extracts the surface that separates samples >= V from samples below it, by marching\n"
     "tetrahedra, from uniform, rectilinear, curvilinear and unstructured grids. Vertices are\n"
     "shared, triangles face the lower values, and the same input gives the same bytes on every\n"
     "device. Two INPUTs are a Plot3D grid and its solution or function file; - is standard input.\n"
     "What gzip has packed is unpacked into memory.\n"
     "\n"
     "  tetracubes extract head.nii.gz --iso 500 -o skin.ply\n"
     "  tetracubes extract head.nii.gz --iso 500 --preview skin.png\n"
     "  tetracubes extract slices/%04d.tif --spacing 0.2,0.2,1 --iso 90 -o cells.glb\n"
     "  tetracubes extract head.nhdr --iso 500,1150 -o head-%.stl --check\n"
     "  tetracubes extract ct.raw --dims 512,512,300 --type i16 --spacing 0.7,0.7,1 --iso 300 -o ct.ply\n"
     "  tetracubes extract ct.nrrd --iso 300 --roi 100:228,:,40: --step 2,2,1 -o part.ply\n"
     "  tetracubes extract dem.mha --iso 0 --nodata -9999 --verify --json\n"
     "  xz -dc ct.nrrd.xz | tetracubes extract - --iso 300 -o ct.ply\n"
     "  tetracubes extract grid.xyz flow.q --field density --iso 2 --carry energy -o shock.vtp\n"
     "  tetracubes extract engine.vtu --field temperature --iso 400 -o hot.ply"},
    {"labels", COMMAND_LABELS, labels_run, NULL, "surfaces of the labels of a segmentation",
     "tetracubes labels INPUT [-o FILE] [options]",
     "Extracts the surfaces between the labels of a segmentation, and between labels and background,\n"
     "as one mesh in which neighbours share their triangles. Labels are whole numbers; 0, negative and\n"
     "missing samples are background. Every triangle has two labels: its inner side's, then its outer\n"
     "side's, of which the lower is inside and the background outside. The surface of each label by\n"
     "itself is a manifold. Surfaces are smoothed.\n"
     "\n"
     "  tetracubes labels organs.nii.gz -o organs.vtp\n"
     "  tetracubes labels organs.nii.gz --labels 1,4,7 --closed --separate -o organ-%.stl\n"
     "  tetracubes labels cells.tif --smooth 0 --check --json"},
    {"join", COMMAND_JOIN, join_run, NULL, "the parts of a surface as one mesh",
     "tetracubes join PARTS... -o FILE [options]",
     "Makes the mesh of the files that 'extract --part I/N' has written, of all N in any order: to the\n"
     "byte the file that one process would write. Parts of other volumes, isovalues or versions,\n"
     "missing, damaged or given twice are refused, and no file is written.\n"
     "\n"
     "  tetracubes extract ct.nrrd --iso 300 --part 0/2 -o ct-0.tcpart\n"
     "  tetracubes extract ct.nrrd --iso 300 --part 1/2 -o ct-1.tcpart\n"
     "  tetracubes join ct-*.tcpart -o ct.ply"},
    {"isovolume", COMMAND_ISOVOLUME, isovolume_run, NULL, "the part of a grid between two values, as tetrahedra",
     "tetracubes isovolume INPUT... --range LO,HI [-o FILE.vtu] [options]",
     "Makes the interval volume, the part of the grid with LO <= f < HI, of tetrahedra that fit together:\n"
     "for finite elements, and to measure. Its border is the surfaces of LO and HI, with the vertices\n"
     "that extract makes, and the part of the grid's own border in between. Reports the volume, and mean\n"
     "and integral of the fields that --carry names; several ranges make a histogram of true volume.\n"
     "A cube that lies within whole makes five tetrahedra: --count tells how many, and the memory.\n"
     "\n"
     "  tetracubes isovolume head.nii.gz --range 500,1150 --count\n"
     "  tetracubes isovolume ct.nrrd --range 300, --roi 100:228,:,40: --check -o bone.vtu\n"
     "  tetracubes isovolume flow.vts --range 1.5,2 --carry energy -o shock.vtu\n"
     "  tetracubes isovolume ct.nrrd --range ,0 --range 0,100 --range 100, --json"},
    {"info", COMMAND_INFO, info_run, NULL, "what a file holds, and isovalues worth trying",
     "tetracubes info INPUT... [options]",
     "Prints the kind of grid, its sizes and place, cells by type and fields with their ranges, for\n"
     "every block; then, of the one field or the one that --field names, the histogram of the finite\n"
     "samples and isovalues worth trying. Two INPUTs are a Plot3D grid and its solution; - is standard\n"
     "input.\n"
     "\n"
     "  tetracubes info head.nii.gz\n"
     "  tetracubes info head.nii.gz --iso 500 --preview slices.png\n"
     "  tetracubes info engine.vtu --field temperature\n"
     "  tetracubes info ct.raw --dims 512,512,300 --type i16 --json"},
    {"tetrahedralize", COMMAND_TETRAHEDRALIZE, tetrahedralize_run, NULL, "a grid cut into tetrahedra that fit together",
     "tetracubes tetrahedralize INPUT... -o FILE.vtu [options]",
     "Cuts the cells of a grid, structured or not, into a conforming complex of tetrahedra: the one\n"
     "that surfaces are extracted from. All fields at points are written, those of cells averaged;\n"
     "several blocks follow each other in one grid. Cells with a corner where the only field, or the\n"
     "one that --field names, has no value are left out. An INPUT of - is standard input.\n"
     "\n"
     "  tetracubes tetrahedralize engine.vtk -o engine-tetrahedra.vtu\n"
     "  tetracubes tetrahedralize grid.xyz flow.q -o flow.vtu"},
    {"devices", COMMAND_DEVICES, devices_run, NULL, "every OpenCL device, with the limits that matter",
     "tetracubes devices [--json]",
     "Lists the devices of all OpenCL platforms. --device takes the index in front, the\n"
     "platform:device pair after it, a type (cpu, gpu) or part of a name."},
    {"generate", COMMAND_GENERATE, generate_run, generate_help, "a volume of an analytic field, to try things on",
     "tetracubes generate FIELD --dims NX,NY,NZ --type T -o FILE [options]",
     "Writes a NRRD file (samples raw, native byte order, aligned so that they can be mapped) or,\n"
     "for an ending of .raw, the samples alone. Coordinate i of n is 2 i / (n - 1) - 1; integer types\n"
     "truncate toward zero and saturate, so that i8 holds no more than 127.\n"
     "\n"
     "  tetracubes generate gyroid --dims 256,256,256 --type u8 -o gyroid.nrrd\n"
     "  tetracubes generate noise --dims 65,33,17 --type f32 --seed 7 -o noise.nrrd"},
    {"selftest", COMMAND_SELFTEST, selftest_run, NULL, "known answers and the reference, on a device",
     "tetracubes selftest [--device SPEC] [--quick] [--vectors [FILE]] [--json] [--junit FILE]",
     "Extracts small volumes on the device, compares counts with known answers and every byte with\n"
     "the scalar reference: types, sizes, ties, missing data, normals, grids, methods, scan, launches,\n"
     "slabs. With --vectors, compares the meshes of volumes up to 512 x 512 x 512 with hashes instead.\n"
     "A driver that crashes or hangs fails the trial at hand; the others go on.\n"
     "Prints a line per group and PASS or FAIL.\n"
     "\n"
     "  tetracubes selftest --device gpu\n"
     "  tetracubes selftest --quick --timeout 300 --junit selftest.xml\n"
     "  tetracubes selftest --vectors"},
};

const size_t command_count = sizeof command_list / sizeof *command_list;

const command *command_find(const char *name) {
    for (size_t n = 0; n < command_count; n++)
        if (strcmp(command_list[n].name, name) == 0) return &command_list[n];
    return NULL;
}
