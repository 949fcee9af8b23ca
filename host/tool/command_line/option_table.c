#include "option_table.h"

#include "mesh_write.h"
#include "option_values.h"
#include "sample_types.h"

#define TYPE_BEHIND_BLANK(type, name, ...) " " #name
#define TYPE_BEFORE_BLANK(type, name, ...) #name " "

#define CHOICES(choices, ...)                                                                                          \
    static const char *choices(int n) {                                                                                \
        static const char *const names[] = {__VA_ARGS__, NULL};                                                        \
        return names[n];                                                                                               \
    }
CHOICES(endian_choices, "little", "big")
CHOICES(engine_choices, "opencl", "reference", "auto")
CHOICES(blocks_choices, "joined", "separate")

#define FORMAT_CHOICE(name, ...) #name,
static const char *format_choices(int n) {
    static const char *const names[] = {MESH_FORMATS(FORMAT_CHOICE) NULL};
    return names[n];
}

/* Those that 'join' writes: piece by piece. */
#define PIECES_NOT(name)
#define PIECES_NUMBERS(name)                                                 #name,
#define PIECES_CORNERS(name)                                                 #name,
#define PIECES_CHOICE(name, label, roles, has_doubles, counts, fits, pieces) PIECES_##pieces(name)
static const char *pieces_choices(int n) {
    static const char *const names[] = {MESH_FORMATS(PIECES_CHOICE) NULL};
    return names[n];
}

static const char *complex_choices(int n) {
    static const char *const names[] = {COMPLEX_FORMATS(FORMAT_CHOICE) NULL};
    return names[n];
}

static const char *view_choices(int n) { return view_name(n); }

static const char *method_choices(int n) { return tc_method_name((tc_method)n); }

static const char *type_choices(int n) { return tc_type_name((tc_type)n); }

#define REPORTS (READS | COMMAND_DEVICES | COMMAND_SELFTEST | COMMAND_JOIN)
#define ALL     (REPORTS | COMMAND_GENERATE)
#define IN(m)   offsetof(options, m)

/* clang-format off */
const option option_table[] = {
    {"--iso", NULL, "V[,V...]", COMMAND_EXTRACT, VALUE_ISOVALUES, IN(isovalues), NULL,
     "isovalue, or several with commas between: samples >= V are inside"},
    {"--iso", NULL, "V[,V...]", COMMAND_INFO, VALUE_ISOVALUES, IN(isovalues), NULL,
     "of --preview: isolines to draw, of one value or of several"},
    {"--range", NULL, "LO,HI", COMMAND_ISOVOLUME, VALUE_INTERVALS, IN(ranges), NULL,
     "LO <= samples < HI are within; LO, and ,HI have one bound; given again:\n"
     "one more range"},
    {"--output", "-o", "FILE", COMMAND_ISOVOLUME, VALUE_TEXT, IN(output), NULL,
     "unstructured grid to write: .vtu (left out: only the report); % in FILE\n"
     "stands for the range as typed, %% for a percent sign; - is standard output"},
    {"--output", "-o", "FILE", COMMAND_EXTRACT, VALUE_TEXT, IN(output), NULL,
     "mesh to write: .ply, .vtp, .stl, .obj, .off, .glb, .npz, .vtkhdf or .html,\n"
     "a page that shows it in a browser (left out: only the report); % in FILE\n"
     "stands for the isovalue as typed, %% for a percent sign; - is standard\n"
     "output (give --format): the report then goes to standard error"},
    {"--labels", NULL, "all|L[,L...]", COMMAND_LABELS, VALUE_LABELS, IN(labels), NULL,
     "labels whose surfaces are made, with commas between (default: all): other\n"
     "samples count as background, which is 0"},
    {"--output", "-o", "FILE", COMMAND_LABELS, VALUE_TEXT, IN(output), NULL,
     "mesh to write: .ply, .vtp, .npz or .vtkhdf, with the two labels of every\n"
     "triangle; .html, a page, or .glb, which show each label in a colour of its\n"
     "own; .stl, .obj or .off (left out: only the report); - is standard output\n"
     "(give --format)"},
    {"--format", NULL, "F", COMMAND_LABELS, VALUE_FORMAT, IN(format), format_choices,
     "ply, vtp, stl, obj, off, glb, html, npz or vtkhdf, whatever FILE ends in"},
    {"--separate", NULL, NULL, COMMAND_LABELS, VALUE_NONE, IN(separate_labels), NULL,
     "write a file for each label, its whole surface: % in FILE stands for the\n"
     "label (%% for a percent sign), which else goes with _ before the ending, as\n"
     "in organs_7.stl"},
    {"--smooth", NULL, "N", COMMAND_LABELS, VALUE_NUMBER, IN(smooth), NULL,
     "sweeps of smoothing (default: 8, at most 1000); vertices stay within their\n"
     "voxel, and surfaces joined where they meet; 0 leaves the stairs of voxels"},
    {"--closed", NULL, NULL, COMMAND_LABELS, VALUE_NONE, IN(closed), NULL,
     "close the surfaces of labels that reach the border of the volume, half a\n"
     "voxel beyond it, as if background were around"},
    {"--output", "-o", "FILE", COMMAND_GENERATE, VALUE_TEXT, IN(output), NULL,
     "volume to write: .nrrd, or .raw for samples without a header; - is NRRD on\n"
     "standard output"},
    {"--output", "-o", "FILE", COMMAND_TETRAHEDRALIZE, VALUE_TEXT, IN(output), NULL,
     "unstructured grid to write: .vtu; - is standard output"},
    {"--format", NULL, "F", COMMAND_ISOVOLUME | COMMAND_TETRAHEDRALIZE, VALUE_FORMAT, IN(format), complex_choices,
     "vtu, whatever FILE ends in"},
    {"--output", "-o", "FILE", COMMAND_JOIN, VALUE_TEXT, IN(output), NULL,
     "mesh to write: .ply, .vtp, .stl or .vtkhdf"},
    {"--format", NULL, "F", COMMAND_JOIN, VALUE_FORMAT, IN(format), pieces_choices,
     "ply, vtp, stl or vtkhdf, whatever FILE ends in"},
    {"--format", NULL, "F", COMMAND_EXTRACT, VALUE_FORMAT, IN(format), format_choices,
     "ply, vtp, stl, obj, off, glb, html, npz or vtkhdf, whatever FILE ends in"},
    {"--preview", NULL, "FILE", COMMAND_EXTRACT, VALUE_TEXT, IN(preview), NULL,
     "picture of the surface to write, as PNG; also without -o; % and --blocks\n"
     "separate name it as they do FILE of -o. Blue is the outer side, which the\n"
     "lower values are on; ochre the inner one"},
    {"--preview", NULL, "FILE", COMMAND_LABELS, VALUE_TEXT, IN(preview), NULL,
     "picture of all surfaces to write, as PNG, each label in a colour of its own;\n"
     "also without -o"},
    {"--preview", NULL, "FILE", COMMAND_INFO, VALUE_TEXT, IN(preview), NULL,
     "picture to write, as PNG: three slices through the middle of a structured\n"
     "grid, with the isolines of --iso"},
    {"--view", NULL, "VIEW", COMMAND_EXTRACT | COMMAND_LABELS, VALUE_VIEW, IN(view), view_choices,
     "of --preview: iso, front, back, left, right, top or bottom, or azimuth and\n"
     "elevation in degrees (default: 30,25): seen from the front, along +y, x runs\n"
     "to the right and z up; the azimuth turns the viewer to the right"},
    {"--preview-size", NULL, "W,H", COMMAND_EXTRACT | COMMAND_INFO | COMMAND_LABELS, VALUE_PIXELS, IN(preview_size), NULL,
     "of --preview: pixels, 16 to 8192 each (default: 1024,768)"},
    {"--field", NULL, "NAME", READS, VALUE_TEXT, IN(field), NULL,
     "field to take, of data with several, see 'tetracubes info' (default:\n"
     "the file's active scalars, if it has such); values of cells, but labels, are\n"
     "averaged to the points between them; point:NAME and cell:NAME choose where\n"
     "both have a field of that name (else that of the points)"},
    {"--carry", NULL, "NAME[,NAME...]", COMMAND_ISOVOLUME, VALUE_TEXT, IN(carry), NULL,
     "fields to have at the vertices; their means and integrals are reported;\n"
     "samples: the field of a file that names none"},
    {"--carry", NULL, "NAME[,NAME...]", COMMAND_EXTRACT, VALUE_TEXT, IN(carry), NULL,
     "other fields, interpolated onto the vertices (PLY, VTP, NPZ, VTKHDF); a\n"
     "name that the file needs itself, as Normals, gets _ at its end"},
    {"--blocks", NULL, "B", COMMAND_EXTRACT, VALUE_CHOICE, IN(separate_blocks), blocks_choices,
     "of data in several blocks: joined (default): one mesh; separate: one\n"
     "file per block, FILE with _b0, _b1, ... before its ending"},
    {"--normals", NULL, NULL, COMMAND_EXTRACT, VALUE_NONE, IN(normals), NULL,
     "write a unit normal per vertex, from the gradient of the samples (not in\n"
     "STL and OFF); structured grids only"},
    {"--soup", NULL, NULL, COMMAND_EXTRACT, VALUE_NONE, IN(soup), NULL,
     "write three vertices of its own for every triangle, none shared"},
    {"--origin-at", NULL, "X,Y,Z", COMMAND_EXTRACT | COMMAND_JOIN | COMMAND_LABELS, VALUE_POINT, IN(origin_at), NULL,
     "write coordinates relative to this point of the input's space (default: the\n"
     "input's own; STL, GLB and HTML, which hold float32 alone, of data far from\n"
     "zero relative to a point near it, which is told)"},
    {"--drop-degenerate", NULL, NULL, COMMAND_EXTRACT, VALUE_NONE, IN(drop_degenerate), NULL,
     "leave out triangles of zero area, as samples that equal the isovalue make:\n"
     "their edges without length are contracted, what was closed stays closed"},
    {"--simplify", NULL, "RATIO", COMMAND_EXTRACT, VALUE_SHARE, IN(simplify), NULL,
     "leave this share of the triangles, 0 to 1, as far as topology allows: edges\n"
     "are contracted, after triangles of zero area were dropped. What is written\n"
     "has the border and the topology of the surface, which is checked; how far\n"
     "the two are apart is measured, and reported"},
    {"--simplify-error", NULL, "D", COMMAND_EXTRACT, VALUE_DISTANCE, IN(simplify_error), NULL,
     "of --simplify: the surfaces may be this far apart, in units of the\n"
     "coordinates, as far as samples tell; more triangles remain where needed"},
    {"--count", NULL, NULL, COMMAND_ISOVOLUME, VALUE_NONE, IN(count), NULL,
     "classify only: count vertices, tetrahedra and bytes, make no volume"},
    {"--count", NULL, NULL, COMMAND_EXTRACT, VALUE_NONE, IN(count), NULL,
     "classify only: count vertices, triangles and active cells, make no mesh"},
    {"--method", NULL, "M", COMMAND_EXTRACT, VALUE_CHOICE, IN(method), method_choices,
     "tetra (default): tetrahedra, five per cube; hybrid: marching cubes whose\n"
     "ambiguous cases the tetrahedra decide; snap: tetrahedra whose samples near\n"
     "the surface are moved onto it, where its topology stays: fewer triangles, of\n"
     "better shape (structured grids). Of unstructured grids hybrid keeps cells\n"
     "whole, polyhedra excepted"},
    {"--snap", NULL, "A", COMMAND_EXTRACT, VALUE_THRESHOLD, IN(snap), NULL,
     "of --method snap: a sample is moved to a crossing at most this part of an\n"
     "edge away, 0 to 0.5 (default: 0.5)"},
    {"--closed", NULL, NULL, COMMAND_EXTRACT, VALUE_NONE, IN(closed), NULL,
     "close the surface where it ends, at the grid's border and beside missing\n"
     "cells, by the inside part of the faces there: the mesh then bounds the\n"
     "volume of samples >= V; each block by itself"},
    {"--engine", NULL, "E", MAKES, VALUE_CHOICE, IN(engine), engine_choices,
     "opencl (default), reference: scalar C, needs no OpenCL, same bytes; or auto:\n"
     "the reference where there is no device, or it fails or gives wrong results"},
    {"--device", NULL, "SPEC", MAKES | COMMAND_SELFTEST, VALUE_TEXT, IN(device), NULL,
     "an index, platform:device, cpu, gpu, gpu:1 or part of a name, see\n"
     "'tetracubes devices'; default: $TETRACUBES_DEVICE, else the first CPU"},
    {"--max-memory", NULL, "SIZE", MAKES, VALUE_BOUND, IN(max_memory), NULL,
     "bound on device buffers, in bytes or with K, M, G, T (powers of 1024), and\n"
     "of streams on the host's memory too: less means smaller slabs and windows,\n"
     "never another result"},
    {"--stream", NULL, NULL, COMMAND_EXTRACT, VALUE_NONE, IN(stream), NULL,
     "read and write window by window, also where all would fit into memory: else\n"
     "it is done where it would not (one structured grid; to PLY, VTP, STL and\n"
     "VTKHDF; not with --check, --verify, --soup, --drop-degenerate, --simplify,\n"
     "--preview)"},
    {"--part", NULL, "I/N", COMMAND_EXTRACT, VALUE_PIECE, IN(part), NULL,
     "make part I, from 0, of N, and write it to FILE, of any ending; 'tetracubes\n"
     "join' makes the mesh of all N, which other processes may have made; of what\n"
     "can be streamed"},
    {"--cut", NULL, "C", COMMAND_EXTRACT, VALUE_CUT, IN(cut), NULL,
     "of ranks (tetracubes-mpi) and parts, which planes each has: even (default);\n"
     "cost: as much to read and to write for each rank; or the planes where all\n"
     "but the first begin, multiples of 4, as in 40,96 for three: all parts of a\n"
     "surface need the same. It never changes the mesh"},
    {"--verify", NULL, NULL, MAKES, VALUE_NONE, IN(verify), NULL,
     "extract with the reference engine too and compare every byte"},
    {"--check", NULL, NULL, COMMAND_ISOVOLUME, VALUE_NONE, IN(check), NULL,
     "check the tetrahedra themselves: how they meet in faces; flat and inverted\n"
     "ones; smallest dihedral angles: least, median, share below 5 and 10 degrees"},
    {"--check", NULL, NULL, COMMAND_EXTRACT, VALUE_NONE, IN(check), NULL,
     "check the mesh itself: manifold, oriented; Euler characteristic, area, of\n"
     "closed surfaces volume (boundary edges are reported, they are no fault);\n"
     "smallest angles of triangles: median, share below 10 and 20 degrees"},
    {"--check", NULL, NULL, COMMAND_LABELS, VALUE_NONE, IN(check), NULL,
     "check the surface of each label by itself: manifold, oriented; Euler\n"
     "characteristic, components, area, of closed surfaces volume"},
    {"--nodata", NULL, "V", READS & ~COMMAND_LABELS, VALUE_NODATA, IN(nodata), NULL,
     "samples equal to V are missing, as are NaN and infinities: a cell with\n"
     "a missing corner is left out; of f32 samples and of scaled ones the float\n"
     "nearest to V counts; of vectors one component equal to V is enough"},
    {"--nodata", NULL, "V", COMMAND_LABELS, VALUE_NODATA, IN(nodata), NULL,
     "samples equal to V are background"},
    {"--skip-unsupported", NULL, NULL, COMMAND_EXTRACT | COMMAND_ISOVOLUME | COMMAND_TETRAHEDRALIZE, VALUE_NONE, IN(skip_unsupported), NULL,
     "leave out cells of types that are not cut, and polyhedra whose faces are\n"
     "not closed, with a notice, instead of refusing the input"},
    {"--component", NULL, "C", READS, VALUE_COMPONENT, IN(component), NULL,
     "which value, from 0, of data with several values per sample; or magnitude:\n"
     "their Euclidean length, as f32, of u32, i32 and f64 values as f64"},
    {"--frame", NULL, "N", READS, VALUE_INDEX, IN(frame), NULL,
     "which volume, from 0, of data with a fourth axis"},
    {"--roi", NULL, "I0:I1,...", TAKES_PARTS, VALUE_INDICES, IN(region.indices), NULL,
     "only the samples of these indices along x, y and z, from I0 to before I1;\n"
     "an end left out, as in 10:,:,:50, is the grid's; regions that share a plane\n"
     "of samples, as 0:65 and 64:129, have surfaces that fit (labels: by --smooth\n"
     "0); structured grids"},
    {"--roi-world", NULL, "X0:X1,...", TAKES_PARTS, VALUE_RANGES, IN(region.world), NULL,
     "the same by a box in the input's space: the fewest samples that cover it"},
    {"--step", NULL, "N[,N,N]", TAKES_PARTS, VALUE_STEP, IN(region.step), NULL,
     "only every Nth sample, from the first one on, along x, y and z; points stay\n"
     "where they are; structured grids"},
    {"--mask", NULL, "FILE", TAKES_PARTS, VALUE_TEXT, IN(mask), NULL,
     "a volume of the input's size, in any format (else raw u8): where it is 0,\n"
     "samples are missing; structured grids"},
    {"--dims", NULL, "NX,NY,NZ", READS, VALUE_DIMS, IN(dims), NULL,
     "raw input: samples along x, y and z, x fastest"},
    {"--dims", NULL, "NX,NY,NZ", COMMAND_GENERATE, VALUE_DIMS, IN(dims), NULL,
     "samples along x, y and z"},
    {"--type", NULL, "T", READS, VALUE_CHOICE, IN(type), type_choices,
     "raw input:" SAMPLE_TYPES(TYPE_BEHIND_BLANK)},
    {"--type", NULL, "T", COMMAND_GENERATE, VALUE_CHOICE, IN(type), type_choices,
     SAMPLE_TYPES(TYPE_BEFORE_BLANK) "(integers truncate and saturate)"},
    {"--endian", NULL, "E", READS, VALUE_CHOICE, IN(big_endian), endian_choices,
     "raw input: little (default) or big"},
    {"--skip", NULL, "BYTES", READS, VALUE_SIZE, IN(skip), NULL,
     "raw input: bytes before the first sample"},
    {"--spacing", NULL, "X,Y,Z", READS, VALUE_SPACING, IN(spacing), NULL,
     "distance of samples along the axes of a uniform grid, in place of what the\n"
     "file says, whose directions stay; raw input without it: 1,1,1"},
    {"--origin", NULL, "X,Y,Z", READS, VALUE_POINT, IN(origin), NULL,
     "position of the first sample of a uniform grid (of VTK's: of index 0,0,0),\n"
     "in place of what the file says; raw input without it: 0,0,0"},
    {"--seed", NULL, "S", COMMAND_GENERATE, VALUE_NUMBER, IN(seed), NULL,
     "of noise, a whole number, default 0"},
    {"--quick", NULL, NULL, COMMAND_SELFTEST, VALUE_NONE, IN(quick), NULL,
     "some trials of every group; of vectors those up to 128 x 128 x 128"},
    {"--vectors", NULL, NULL, COMMAND_SELFTEST, VALUE_NONE, IN(vectors), NULL,
     "compare with a list of hashes: that of a FILE given, else the tool's own"},
    {"--timeout", NULL, "SECONDS", COMMAND_SELFTEST, VALUE_NUMBER, IN(timeout), NULL,
     "no trial goes on longer: those that are left then fail"},
    {"--junit", NULL, "FILE", COMMAND_SELFTEST, VALUE_TEXT, IN(junit), NULL,
     "write a JUnit file too: a suite per group, a case per trial"},
    {"--json", NULL, NULL, REPORTS, VALUE_NONE, IN(json), NULL,
     "print the results as one JSON object"},
    {"--quiet", NULL, NULL, READS | COMMAND_GENERATE | COMMAND_JOIN, VALUE_NONE, IN(quiet), NULL,
     "no progress, no notices, no report in words"},
    {"--help", "-h", NULL, ALL, VALUE_NONE, IN(help), NULL,
     "print this"},
};
/* clang-format on */

const size_t option_table_count = sizeof option_table / sizeof *option_table;

_Static_assert(sizeof option_table / sizeof *option_table <= OPTION_TABLE_MOST, "options.given has a bit for each");
