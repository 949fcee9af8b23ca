#!/usr/bin/env python3
"""test_cli_images.py TOOL - what the command line says in place of an image's header, and chooses from it

--spacing and --origin for every kind of uniform input, --component magnitude, and what info says of an input that leaves
a choice open: frames, values per sample, fields. By the reference engine. With TETRACUBES_DATA set, the inputs there
that public reports are about are read too.
"""
import bz2
import math
import os
import struct
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "common"))
import tool_case
from grid_files import lattice, numbers, structured_text, vti_text, vts_text
from tool_case import GridCase

DATA = os.environ.get("TETRACUBES_DATA")
DIMS = (5, 4, 3)
VECTORS = [(x - 1.5, 2.0 * y, float(z)) for x, y, z in lattice(DIMS)]
LENGTHS = [math.sqrt(x * x + y * y + z * z) for x, y, z in VECTORS]
NRRD = "NRRD0005\ntype: {}\ndimension: {}\nsizes: {}\nendian: little\nencoding: raw\n{}\n"


def legacy_text(more, values):
    return ("# vtk DataFile Version 3.0\nt\nASCII\nDATASET STRUCTURED_POINTS\nDIMENSIONS 5 4 3\n" + more
            + "POINT_DATA 60\nSCALARS s float\nLOOKUP_TABLE default\n" + numbers(values) + "\n")


class ImageCase(GridCase):
    def write_bytes(self, name, header, samples=b""):
        with open(self.path(name), "wb") as f:
            f.write(header.encode() + samples)
        return self.path(name)

    def write_scalars(self, name="s.nrrd", more=""):
        values = [float(x) for x, y, z in lattice(DIMS)]
        return self.write_bytes(name, NRRD.format("float", 3, "5 4 3", more), struct.pack("<60f", *values))

    def write_vectors(self, name="v.nrrd", kind="f", code="float", scale=1):
        flat = [value * scale if kind in "fd" else int(value * scale) for vector in VECTORS for value in vector]
        return self.write_bytes(name, NRRD.format(code, 4, "3 5 4 3", "kinds: vector domain domain domain\n"),
                                struct.pack(f"<180{kind}", *flat))

    def write_nifti(self, name, sizes, datatype, samples, intent=0, slope=0.0, intercept=0.0):
        header = bytearray(352)
        struct.pack_into("<i", header, 0, 348)
        struct.pack_into("<8h", header, 40, len(sizes), *sizes, *[1] * (7 - len(sizes)))
        struct.pack_into("<h", header, 68, intent)
        struct.pack_into("<2h", header, 70, datatype, {2: 8, 4: 16, 8: 32, 16: 32, 64: 64}[datatype])
        struct.pack_into("<8f", header, 76, *[1] * 8)
        struct.pack_into("<3f", header, 108, 352, slope, intercept)
        header[344:348] = b"n+1\0"
        with open(self.path(name), "wb") as f:
            f.write(bytes(header) + samples)
        return self.path(name)

    def bounds(self, *arguments):
        report = self.report("extract", *arguments, "--engine", "reference", "--check")
        return report["surfaces"][0]["bounds"]


class Placement(ImageCase):
    def test_every_uniform_input(self):
        values = [float(x) for x, y, z in lattice(DIMS)]
        inputs = [self.write_scalars(), self.write_scalars("w.nrrd", "spacings: 7 0 nan\naxis mins: nan inf 3\n"),
                  self.write("a.vtk", legacy_text("SPACING 0 0 0\nORIGIN nan 1 1\n", values)),
                  self.write("b.vtk", legacy_text("", values)),
                  self.write_bytes("a.mha", "NDims = 3\nDimSize = 5 4 3\nElementType = MET_FLOAT\n"
                                   "ElementSpacing = 0 1\nElementDataFile = LOCAL\n", struct.pack("<60f", *values))]
        if "VTK XML" in self.expect(0, "--version").stdout:
            inputs.append(self.write("a.vti", vti_text(DIMS, [("s", "f32", values)])))
        placed = ["--spacing", "2,3,0.5", "--origin", "10,20,-30"]
        for path in inputs:
            with self.subTest(path=path):
                info = self.report("info", path, *placed)
                self.assertEqual(info["spacing"], [2, 3, 0.5])
                self.assertEqual(info["matrix"], [[2, 0, 0, 10], [0, 3, 0, 20], [0, 0, 0.5, -30]])
                self.assertEqual(self.bounds(path, "--iso", "1.5", *placed), [[13, 20, -30], [13, 29, -29]])
                self.expect(0, "tetrahedralize", path, *placed, "-o", self.path("t.vtu"))
                tetrahedra = self.report("info", self.path("t.vtu"))
                self.assertEqual(tetrahedra["blocks"][0]["bounds"], [[10, 20, -30], [18, 29, -29]])

    def test_one_of_the_two(self):
        path = self.write_scalars("a.nrrd", "spacings: 2 3 4\naxis mins: 1 2 3\ncenters: node node node\n")
        self.assertEqual(self.report("info", path, "--spacing", "5,6,7")["matrix"],
                         [[5, 0, 0, 1], [0, 6, 0, 2], [0, 0, 7, 3]])
        self.assertEqual(self.report("info", path, "--origin", "0,0,9")["matrix"],
                         [[2, 0, 0, 0], [0, 3, 0, 0], [0, 0, 4, 9]])

    def test_directions_stay(self):
        path = self.write_scalars("a.nrrd", "space: RAS\nspace directions: (0,-4,0) (3,0,4) (8,0,-6)\n")
        matrix = self.report("info", path, "--spacing", "1,10,5")["matrix"]
        wanted = [[0, 6, 4, 0], [-1, 0, 0, 0], [0, 8, -3, 0]]
        for row, expected in zip(matrix, wanted):
            for number, other in zip(row, expected):
                self.assertAlmostEqual(number, other, places=14)

    def test_extents_keep_their_places(self):
        self.needs_xml()
        values = [float(x) for x, y, z in lattice(DIMS, (3, 0, 0))]
        path = self.write("a.vti", vti_text(DIMS, [("s", "f32", values)], first=(3, 0, 0)))
        bounds = self.bounds(path, "--iso", "4.5", "--spacing", "2,1,1", "--origin", "100,0,0")
        self.assertEqual(bounds, [[109, 0, 0], [109, 3, 2]])

    def test_extents_of_32_bits(self):
        """Coordinates written are those of the extent; float32 holds neither its indices nor these."""
        self.needs_xml()
        first = (2 ** 31 - 5, -2 ** 31, 2 ** 25 + 1)
        values = [float(x) for x, y, z in lattice(DIMS)]
        text = structured_text("ImageData", DIMS, first, "", [("s", "f32", values)], (),
                               ' Origin="7 0 0" Spacing="0.25 1 2"')
        path = self.write("a.vti", text)
        near = self.write("b.vti", vti_text(DIMS, [("s", "f32", values)], first=(1, 0, 1)))
        meshes = []
        for at, name in ((path, "a.obj"), (near, "b.obj")):
            self.expect(0, "extract", at, "--iso", "1.5", "--engine", "reference", "--check", "-o", self.path(name))
            with open(self.path(name), encoding="ascii") as f:
                rows = [line.split() for line in f if line[:1] in "vf"]
            meshes.append(([tuple(map(float, row[1:])) for row in rows if row[0] == "v"],
                           [row[1:] for row in rows if row[0] == "f"]))
        self.assertEqual(meshes[0][1], meshes[1][1])
        moved = [(7 + 0.25 * (x - 1 + first[0]), y + first[1], 2 * (z - 1 + first[2])) for x, y, z in meshes[1][0]]
        self.assertEqual(meshes[0][0], moved)
        for beyond in ("2147483647 2147483648 0 1 0 1", "-2147483649 -2147483648 0 1 0 1"):
            with open(path, encoding="ascii") as f:
                text = f.read().replace(" ".join(f"{first[n]} {first[n] + DIMS[n] - 1}" for n in range(3)), beyond)
            self.refuses(4, "info", self.write("c.vti", text), says="Extent.*of 32 bits")

    def test_grids_with_coordinates_refuse(self):
        pair = self.write_plot3d("a", [(DIMS, lattice(DIMS), [float(p[0]) for p in lattice(DIMS)])])
        inputs = [pair + ["--field", "density"]]
        if "VTK XML" in self.expect(0, "--version").stdout:
            inputs.append([self.write("a.vts", vts_text(DIMS, lattice(DIMS), [("s", "f32", [1.0] * 60)]))])
        for given in inputs:
            for option in (["--spacing", "1,1,2"], ["--origin", "0,0,1"]):
                self.refuses(2, "extract", *given, "--iso", "1", *option, says=f"coordinates of their own.*{option[0]}")
                self.refuses(2, "info", *given, *option, says="coordinates of their own")
                self.refuses(2, "tetrahedralize", *given, *option, "-o", self.path("t.vtu"), says="coordinates of")

    def test_wrong_values_are_told_with_the_option(self):
        self.refuses(4, "info", self.write_scalars("a.nrrd", "spacings: 1 0 1\n"), says="axis 2 is 0.*--spacing")
        self.refuses(4, "info", self.write_scalars("a.nrrd", "axis mins: 1 inf 1\n"), says="--origin")


    def test_no_direction(self):
        values = [float(x) for x, y, z in lattice(DIMS)]
        inputs = [self.write_bytes("a.mha", "NDims = 3\nDimSize = 5 4 3\nTransformMatrix = 1 0 0 0 0 0 0 0 1\n"
                                   "ElementType = MET_FLOAT\nElementDataFile = LOCAL\n", struct.pack("<60f", *values))]
        if "VTK XML" in self.expect(0, "--version").stdout:
            text = vti_text(DIMS, [("s", "f32", values)])
            inputs.append(self.write("a.vti", text.replace("<ImageData ", '<ImageData Direction="1 0 0 0 0 0 0 0 1" ')))
        for path in inputs:
            self.refuses(4, "info", path, says="(TransformMatrix|Direction) has only zeros for axis 2")
            self.expect(0, "info", path, "--spacing", "1,1,1")


class Magnitude(ImageCase):
    def check_range(self, path, values, kind, *more):
        info = self.report("info", path, "--component", "magnitude", *more)
        self.assertEqual(info["type"], kind)
        low, high = info["range"]
        places = 6 if kind == "f32" else 14
        self.assertAlmostEqual(low / (min(values) or 1), bool(min(values)), places=places)
        self.assertAlmostEqual(high / max(values), 1, places=places)

    def test_images(self):
        for kind, code, scale, result in (("f", "float", 1, "f32"), ("d", "double", 1, "f64"), ("b", "int8", 2, "f32"),
                                          ("h", "short", 200, "f32"), ("i", "int", 200000, "f64"),
                                          ("q", "longlong", 2000, "f64"), ("f", "float", 1e30, "f32"),
                                          ("d", "double", 1e300, "f64"), ("d", "double", 1e-200, "f64")):
            with self.subTest(code=code, scale=scale):
                path = self.write_vectors(kind=kind, code=code, scale=scale)
                self.check_range(path, [length * scale for length in LENGTHS], result)

    def test_surface_is_that_of_the_lengths(self):
        lengths = self.write_bytes("l.nrrd", NRRD.format("float", 3, "5 4 3", ""), struct.pack("<60f", *LENGTHS))
        wanted = self.report("extract", lengths, "--iso", "2.1", "--engine", "reference")["surfaces"][0]
        self.assertGreater(wanted["triangles"], 0)
        files = [self.write_vectors()]
        flat = [value for vector in VECTORS for value in vector]
        if "VTK XML" in self.expect(0, "--version").stdout:
            files.append(self.write("a.vti", vti_text(DIMS, [("v", "f32", flat, 3)])))
        planes = [value for c in range(3) for value in (vector[c] for vector in VECTORS)]
        files.append(self.write_bytes("p.nrrd", NRRD.format("float", 4, "5 4 3 3", "kinds: space space space vector\n"),
                                      struct.pack("<180f", *planes)))
        for path in files:
            got = self.report("extract", path, "--component", "magnitude", "--iso", "2.1", "--engine", "reference")
            self.assertEqual(got["surfaces"][0]["hash"], wanted["hash"], path)

    def test_cells(self):
        self.needs_xml()
        path = self.write("c.vti", vti_text((2, 2, 2), (), [("v", "f64", [3.0, 4.0, 12.0], 3)]))
        self.assertEqual(self.report("info", path, "--component", "magnitude")["range"], [13, 13])

    def test_missing_values(self):
        flat = [value for vector in VECTORS for value in vector]
        flat[7] = float("nan")
        path = self.write_bytes("n.nrrd", NRRD.format("float", 4, "3 5 4 3", "kinds: vector domain domain domain\n"),
                                struct.pack("<180f", *flat))
        self.assertEqual(self.report("info", path, "--component", "magnitude")["nonfinite"], 1)

    def check_nodata(self, path, *more):
        """Two vectors of the file have a component of -9999, one of them in all components."""
        words = [path, "--component", "magnitude", *more]
        info = self.report("info", *words, "--nodata=-9999")
        self.assertEqual((info["missing"], info["notices"]), (2, [n for n in info["notices"] if "averaged" in n]), path)
        self.assertAlmostEqual(info["range"][1] / max(LENGTHS), 1, places=6)
        self.assertIn("nothing is left out", self.expect(0, "info", *words, "--nodata=9999").stderr)
        return self.report("extract", *words, "--iso", "2.1", "--nodata=-9999", "--engine", "reference")["surfaces"][0]

    def test_nodata_is_of_components(self):
        vectors = list(VECTORS)
        vectors[0] = (-9999.0,) * 3
        vectors[27] = (1.0, -9999.0, 1.0)
        lengths = [math.nan if -9999 in vector else length for vector, length in zip(vectors, LENGTHS)]
        wanted = self.report("extract", self.write_bytes("l.nrrd", NRRD.format("float", 3, "5 4 3", ""),
                                                         struct.pack("<60f", *lengths)),
                             "--iso", "2.1", "--engine", "reference")["surfaces"][0]
        self.assertGreater(wanted["triangles"], 0)
        flat = [value for vector in vectors for value in vector]
        samples = struct.pack("<180f", *flat)
        files = [self.write_bytes("v.nrrd", NRRD.format("float", 4, "3 5 4 3", "kinds: vector domain domain domain\n"),
                                  samples),
                 self.write_bytes("v.mha", "NDims = 3\nDimSize = 5 4 3\nElementNumberOfChannels = 3\n"
                                  "ElementType = MET_FLOAT\nElementDataFile = LOCAL\n", samples)]
        version = self.expect(0, "--version").stdout
        if "NIfTI" in version:
            planes = struct.pack("<180f", *(vector[c] for c in range(3) for vector in vectors))
            files.append(self.write_nifti("v.nii", (5, 4, 3, 1, 3), 16, planes, intent=1007))
        if "VTK XML" in version:
            files.append(self.write("v.vti", vti_text(DIMS, [("v", "f32", flat, 3)])))
            files.append(self.write("v.vts", vts_text(DIMS, lattice(DIMS), [("v", "f32", flat, 3)])))
        for path in files:
            self.assertEqual(self.check_nodata(path)["triangles"], wanted["triangles"], path)

    def test_nodata_of_cells(self):
        self.needs_xml()
        flat = [3.0, 4.0, 12.0] * 3 + [3.0, -9999.0, 12.0]
        path = self.write("c.vti", vti_text((3, 3, 2), (), [("v", "f64", flat, 3)]))
        info = self.report("info", path, "--component", "magnitude", "--nodata=-9999")
        self.assertEqual(info["range"], [13, 13])

    def test_refused(self):
        scalars = self.write_scalars()
        self.refuses(2, "extract", scalars, "--iso", "1", "--component", "magnitude", says="one value per sample")
        legacy = self.write("a.vtk", legacy_text("", [1.0] * 60))
        self.refuses(2, "extract", legacy, "--iso", "1", "--component", "magnitude", says="no vectors")
        for text in ("length", "magnitudes", "", "-2", "1.5"):
            self.refuses(2, "extract", self.write_vectors(), "--iso", "1", "--component", text, says="--component")


class Scaled(ImageCase):
    """Slope and intercept are floats: a missing value is typed as their decimals have it."""

    def setUp(self):
        super().setUp()
        if "NIfTI" not in self.expect(0, "--version").stdout:
            self.skipTest("no NIfTI")

    def left_out(self, path, text):
        info = self.report("info", path, "--nodata=" + text)
        count = self.report("extract", path, "--iso", "1.05", "--nodata=" + text, "--engine", "reference", "--count")
        is_vain = any("nothing is left out" in n for n in info["notices"])
        return info["missing"], is_vain, info["range"], count["surfaces"]

    def test_nodata(self):
        stored = [10 * x for x, y, z in lattice(DIMS)]
        stored[:7] = [-32768] * 7
        samples = struct.pack("<60h", *stored)
        whole = self.report("extract", self.write_nifti("a.nii", DIMS, 4, samples, slope=0.1), "--iso", "1.05",
                            "--engine", "reference", "--count")["surfaces"][0]["triangles"]
        for text in ("-3276.8", "-3276.800048828125", "-32768e-1"):
            missing, is_vain, (low, _), [surface] = self.left_out(self.path("a.nii"), text)
            self.assertEqual((missing, is_vain, low), (7, False, 0.0), text)
            self.assertLess(surface["triangles"], whole)
        for text in ("-32768", "-3276.9", "-3276.81", "1e300"):
            missing, is_vain, (low, _), [surface] = self.left_out(self.path("a.nii"), text)
            self.assertEqual((missing, is_vain, surface["triangles"]), (0, True, whole), text)
        path = self.write_nifti("b.nii", DIMS, 4, samples, slope=0.1, intercept=-100.7)
        self.assertEqual(self.left_out(path, "-3377.5")[0], 7)

    def test_vectors(self):
        stored = [10] * 180
        stored[130] = -32768
        path = self.write_nifti("v.nii", (5, 4, 3, 1, 3), 4, struct.pack("<180h", *stored), intent=1007, slope=0.1)
        self.assertEqual(self.report("info", path, "--component", "magnitude", "--nodata=-3276.8")["missing"], 1)
        self.assertEqual(self.report("info", path, "--component", "2", "--nodata=-3276.8")["missing"], 1)
        self.assertEqual(self.report("info", path, "--component", "1", "--nodata=-3276.8")["missing"], 0)


class Description(ImageCase):
    def test_values_per_sample(self):
        path = self.write_vectors()
        self.refuses(2, "extract", path, "--iso", "1", says="--component 0 to 2.*magnitude")
        info = self.report("info", path)
        self.assertEqual(info["choices"], [{"option": "--component", "count": 3, "meaning": ""}])
        self.assertEqual((info["dims"], info["type"], info["range"]), ([5, 4, 3], None, None))
        [field] = info["blocks"][0]["fields"]
        self.assertEqual((field["components"], field["type"]), (3, "f32"))
        self.assertEqual(field["ranges"], [[-1.5, 2.5], [0, 6], [0, 2]])
        text = self.expect(0, "info", path).stdout
        self.assertRegex(text, r"(?m)^dimensions    5 x 4 x 3 f32$")
        self.assertRegex(text, r"(?m)^values        3 per sample\n  0           -1.5 to 2.5$")
        self.assertRegex(text, r"(?m)^choose .* --component 0 to 2, .* --component magnitude$")
        for more in ("--component=1", "--component=magnitude"):
            self.assertEqual(self.report("info", path, more)["choices"], [])

    def test_frames(self):
        frames = struct.pack("<120h", *range(120))
        path = self.write_bytes("f.nrrd", NRRD.format("short", 4, "5 4 3 2", ""), frames)
        self.refuses(2, "extract", path, "--iso", "1", says="2 frames; choose one with --frame 0 to 1")
        info = self.report("info", path)
        self.assertEqual(info["choices"], [{"option": "--frame", "count": 2}])
        self.assertEqual((info["dims"], info["type"], info["range"]), ([5, 4, 3], "i16", [0, 59]))
        self.assertRegex(self.expect(0, "info", path).stdout, r"(?m)^choose +one of 2 frames by --frame 0 to 1")
        second = self.report("info", path, "--frame", "1")
        self.assertEqual((second["choices"], second["range"]), ([], [60, 119]))
        self.refuses(2, "info", path, "--frame", "2", says="--frame 0 to 1")

    def test_frames_of_colours(self):
        path = self.write_bytes("f.mha", "NDims = 4\nDimSize = 5 4 3 2\nElementType = MET_UCHAR\n"
                                "ElementNumberOfChannels = 3\nElementDataFile = LOCAL\n", bytes(range(180)) * 2)
        options = [choice["option"] for choice in self.report("info", path)["choices"]]
        self.assertEqual(options, ["--component", "--frame"])
        self.assertEqual(self.report("info", path, "--component", "2", "--frame", "1")["range"], [2, 179])

    def test_fields(self):
        values = numbers([1.0] * 60)
        path = self.write("a.vtk", legacy_text("", [float(n) for n in range(60)])
                          + f"SCALARS t float\nLOOKUP_TABLE default\n{values}\nVECTORS v float\n"
                          + numbers(value for vector in VECTORS for value in vector) + "\n")
        info = self.report("info", path)
        self.assertEqual(info["choices"], [{"option": "--field", "names": ["s", "t", "v"], "taken": "s"}])
        self.assertEqual((info["field"], info["range"]), ("s", [0, 59]))
        self.assertRegex(self.expect(0, "info", path).stdout, "(?m)^choose .* --field NAME.* without it 's' is taken$")
        self.assertEqual(self.report("info", path, "--field", "s")["choices"], [])
        vector = self.report("info", path, "--field", "v")
        self.assertEqual(vector["choices"], [{"option": "--component", "count": 3, "meaning": ""}])
        self.assertIn("--component 0 to 2", self.expect(0, "info", path, "--field", "v").stdout)
        self.refuses(2, "info", path, "--field", "none", says="none")
        said = self.expect(0, "extract", path, "--iso", "30", "--engine", "reference").stderr
        self.assertIn("'s' is taken, its active scalars", said)
        said = self.expect(0, "extract", path, "--iso", "30", "--engine", "reference", "--field", "s").stderr
        self.assertNotIn("is taken", said)


class Reports(ImageCase):
    def test_mask_that_bzip2_packs_a_million_times(self):
        mask = bytearray(256 ** 3)
        mask[128 * 65793] = 1
        path = self.write_bytes("m.nrrd", "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 256 256 256\nencoding: bzip2\n\n",
                                bz2.compress(bytes(mask), 9))
        self.assertEqual(self.bounds(path, "--iso", "0.5"), [[127.5] * 3, [128.5] * 3])

    def test_notices(self):
        path = self.write_scalars("a.nrrd", "spacings: nan 1 1\n")
        extract = ["extract", path, "--iso", "1.5", "--engine", "reference"]
        self.assertRegex(self.expect(0, *extract).stderr, "axis 1 is not known")
        self.assertEqual(self.expect(0, *extract, "--quiet").stderr, "")
        self.assertRegex(self.report("info", path)["notice"], "axis 1 is not known")

    def test_files_of_public_reports(self):
        if not DATA or not os.path.isdir(os.path.join(DATA, "reports")):
            self.skipTest("no files of reports in TETRACUBES_DATA")
        for name, spacing in (("byteskip_minus1_gzip.nhdr", 1), ("spacing_nan.nrrd", None), ("hex.nrrd", 1),
                              ("spacing_4_of_3.mha", 2), ("dim4_is_0.nii", None), ("pixdim_0.nii", 1),
                              ("UPPER.HDR", None), ("four_d.nii", None), ("pixdim_0_sform.nii", None)):
            with self.subTest(file=name):
                info = self.report("info", os.path.join(DATA, "reports", name))
                self.assertEqual((info["dims"], info["range"]), ([4, 4, 4], [0, 3]))
                if spacing:
                    self.assertEqual(info["spacing"], [spacing] * 3)


if __name__ == "__main__":
    tool_case.main(device=False)
