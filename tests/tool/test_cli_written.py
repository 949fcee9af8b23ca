#!/usr/bin/env python3
"""test_cli_written.py TOOL [reference] - GLB, NPZ, HTML and OFF against PLY, by code that knows their formats; numpy

What glTF asks for is checked here: chunks, alignment, views, accessors, exact bounds, indices. NPZ is read by zipfile,
which looks at every check sum, and by numpy where Python has it; so are .npy files that numpy has written. Where trimesh
and pygltflib are there, they read the files, too.
"""
import importlib
import itertools
import json
import math
import os
import re
import struct
import sys
import zipfile

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "common"))
import tool_case
from meshes import glb_parts, html_scripts, npz_arrays, ply_vertices, read_ply, READERS
from tool_case import GridCase

REFERENCE = ("--engine", "reference")


def module(name):
    """The module, or None where Python has none of that name."""
    try:
        return importlib.import_module(name)
    except ImportError:
        return None


numpy, trimesh, pygltflib, h5py = map(module, ("numpy", "trimesh", "pygltflib", "h5py"))


class Written(GridCase):
    def setUp(self):
        super().setUp()
        self.volume = self.generate("gyroid", "g.nrrd", "24,22,20")

    def written(self, ending, *more, source=None, iso="127.5"):
        path = self.path("out." + ending)
        self.expect(0, "extract", source or self.volume, "--iso", iso, *REFERENCE, "--quiet", "-o", path, *more)
        return path

    def test_same_mesh(self):
        for more in ([], ["--soup"]):
            points, faces, _ = read_ply(self.written("ply", *more))
            for ending in ("off", "glb", "npz", "html"):
                is_points, is_faces, _ = READERS[ending](self.written(ending, *more))
                exact = [tuple(struct.unpack("<3f", struct.pack("<3f", *p))) for p in is_points]
                self.assertEqual((exact, is_faces), (points, faces), (ending, more))

    def check_glb(self, path):
        """All that the format asks for of such a file."""
        description, binary = glb_parts(path)
        self.assertEqual(description["asset"]["version"], "2.0")
        self.assertEqual([buffer["byteLength"] for buffer in description["buffers"]], [len(binary)])
        end = 0
        for view in description["bufferViews"]:
            self.assertEqual((view["buffer"], view["byteOffset"], view["byteOffset"] % 4), (0, end, 0))
            end += view["byteLength"]
        self.assertEqual(end, len(binary))
        primitive, = description["meshes"][0]["primitives"]
        used = [*primitive["attributes"].values(), primitive["indices"]]
        self.assertEqual(sorted(used), list(range(len(description["accessors"]))))
        arrays = []
        for accessor, view in zip(description["accessors"], description["bufferViews"]):
            code, size = {5126: ("f", 4), 5125: ("I", 4)}[accessor["componentType"]]
            count = accessor["count"] * {"VEC3": 3, "SCALAR": 1}[accessor["type"]]
            self.assertEqual(view["byteLength"], count * size)
            arrays.append(struct.unpack_from(f"<{count}{code}", binary, view["byteOffset"]))
        points = arrays[primitive["attributes"]["POSITION"]]
        bounds = description["accessors"][primitive["attributes"]["POSITION"]]
        for axis in range(3):
            kept = [struct.unpack("<f", struct.pack("<f", bounds[end][axis]))[0] for end in ("min", "max")]
            self.assertEqual(kept, [min(points[axis::3]), max(points[axis::3])])
        self.assertLess(max(arrays[primitive["indices"]]), len(points) // 3)
        self.assertEqual(len(arrays[primitive["indices"]]) % 3, 0)
        self.assertEqual(primitive["material"], 0)
        self.assertEqual(len(description["materials"]), 1)
        for n in range(0, len(arrays[1]) if len(arrays) > 2 else 0, 3):
            self.assertAlmostEqual(math.hypot(*arrays[1][n:n + 3]), 1, 4)
        return len(points) // 3, len(arrays[primitive["indices"]]) // 3

    def test_glb(self):
        for more in ([], ["--normals"], ["--soup", "--normals"]):
            path = self.written("glb", *more)
            counts = self.check_glb(path)
            vertices, faces = ply_vertices(self.written("ply", *more))
            self.assertEqual(counts, (len(vertices), len(faces)))
            if trimesh:
                shape, = trimesh.load(path, process=False).geometry.values()
                self.assertEqual((len(shape.vertices), len(shape.faces)), counts)
            if pygltflib:
                self.assertEqual(pygltflib.GLTF2().load(path).accessors[0].count, counts[0])
        description, binary = glb_parts(self.written("glb", iso="300"))
        self.assertEqual((description["scenes"], binary), ([{}], b""))

    def test_values_in_npz(self):
        source = self.write("a.vtk", "# vtk DataFile Version 3.0\nt\nASCII\nDATASET STRUCTURED_POINTS\nDIMENSIONS 5 4 3\n"
                            "ORIGIN 1000000 0 0\nPOINT_DATA 60\nSCALARS s float\nLOOKUP_TABLE default\n"
                            + " ".join(str(n % 7) for n in range(60)) + "\nSCALARS faces float 2\nLOOKUP_TABLE default\n"
                            + " ".join(str(n) for n in range(120)) + "\nSCALARS ../b float\nLOOKUP_TABLE default\n"
                            + " ".join(str(n) for n in range(60)) + "\n")
        carried = ["--field", "s", "--carry", "faces,../b"]
        path = self.written("npz", *carried, source=source, iso="2.5")
        arrays = npz_arrays(path)
        vertices, faces = ply_vertices(self.written("ply", *carried, source=source, iso="2.5"))
        self.assertEqual({name: kind for name, (kind, _, _) in arrays.items()},
                         {"vertices": "<f8", "faces": "<u4", "faces_": "<f4", "___b": "<f4"})
        self.assertEqual(list(zip(*[iter(arrays["vertices"][2])] * 3)), [(v["x"], v["y"], v["z"]) for v in vertices])
        self.assertEqual(list(zip(*[iter(arrays["faces"][2])] * 3)), faces)
        self.assertEqual(list(zip(*[iter(arrays["faces_"][2])] * 2)), [(v["faces_0"], v["faces_1"]) for v in vertices])
        self.assertEqual(list(arrays["___b"][2]), [v["___b"] for v in vertices])
        if numpy:
            with numpy.load(path) as archive:
                for name, (kind, shape, values) in arrays.items():
                    self.assertEqual((archive[name].dtype.str, archive[name].shape), (kind, shape))
                    self.assertEqual(archive[name].ravel().tolist(), list(values))

    def has_vtkhdf(self):
        return "VTKHDF" in self.expect(0, "--version").stdout.split("writes:")[1]

    def test_vtkhdf(self):
        if not h5py or not self.has_vtkhdf():
            self.skipTest("no h5py or built without libhdf5")
        for iso, more in (("127.5", []), ("127.5", ["--soup", "--normals"]), ("300", ["--normals"])):
            points, faces, _ = read_ply(self.written("ply", *more, iso=iso))
            with h5py.File(self.written("vtkhdf", *more, iso=iso)) as file:
                root = file["VTKHDF"]
                self.assertEqual((root.attrs["Type"], list(root.attrs["Version"])), (b"PolyData", [2, 0]))
                self.assertEqual([tuple(p) for p in root["Points"][()].tolist()], points)
                corners = root["Polygons/Connectivity"][()]
                self.assertEqual([tuple(t) for t in corners.reshape(-1, 3).tolist()], faces)
                self.assertEqual(root["Polygons/Offsets"][()].tolist(), list(range(0, 3 * len(faces) + 1, 3)))
                self.assertEqual(corners.dtype, "<i4")
                counts = [root[name][0] for name in ("NumberOfPoints", "Polygons/NumberOfCells",
                                                     "Polygons/NumberOfConnectivityIds", "Lines/NumberOfCells")]
                self.assertEqual(counts, [len(points), len(faces), 3 * len(faces), 0])
                self.assertEqual("Normals" in root["PointData"], "--normals" in more and bool(faces))

    def test_empty_npz(self):
        arrays = npz_arrays(self.written("npz", iso="300"))
        self.assertEqual({name: shape for name, (_, shape, _) in arrays.items()}, {"vertices": (0, 3), "faces": (0, 3)})

    def test_page(self):
        """A page loads nothing: no address stands in it, and its own policy forbids to ask for any."""
        path = self.written("html", "--normals")
        with open(path, encoding="utf-8") as file:
            page = file.read()
        self.assertRegex(page, r"""content="default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'""")
        for fetches in (r"\b(https?|wss?|ftp):", r"\bsrc=", r"url\(", r"@import", r"\bimport\b", r"\bfetch\(", "XMLHttp",
                        r'href="(?!data:,)'):
            self.assertNotRegex(page, fetches)
        normals = struct.iter_unpack("<3f", html_scripts(path)["normals"])
        self.assertTrue(all(abs(math.hypot(*normal) - 1) < 1e-4 for normal in normals))

    def test_stream(self):
        for ending in ("glb", "npz", "html", "off", *(["vtkhdf"] if self.has_vtkhdf() else [])):
            with open(self.written(ending), "rb") as file:
                good = file.read()
            with open(self.path("stream"), "wb") as out:
                done = tool_case.subprocess.run([tool_case.TOOL, "extract", self.volume, "--iso", "127.5", *REFERENCE,
                                                 "--quiet", "-o", "-", "--format", ending], stdout=out, timeout=400)
            with open(self.path("stream"), "rb") as file:
                self.assertEqual((done.returncode, file.read()), (0, good))

    def named(self, header):
        """A NRRD file of 4 x 4 x 4 samples with these lines in its header."""
        samples = bytes(n * 37 % 251 for n in range(64))
        return self.write("named.nrrd", f"NRRD0005\ntype: uchar\ndimension: 3\nsizes: 4 4 4\nencoding: raw\n{header}\n"
                          .encode() + samples)

    def notes(self, source, *more):
        """What each format says of space and units."""
        found = {}
        for ending in ("ply", "stl", "obj", "vtp", "glb", "html", "off", "npz"):
            with open(self.written(ending, *more, source=source, iso="127.5"), "rb") as file:
                content = file.read()
            text = content.decode("latin-1")
            if ending == "glb":
                notes = glb_parts(self.path("out.glb"))[0]["asset"].get("extras", {})
            elif ending == "html":
                notes = dict(note.split("=") for note in html_scripts(self.path("out.html"))["mesh"]["notes"])
            elif ending == "vtp":
                arrays = re.findall(r'<Array type="String" Name="(\w+)" NumberOfTuples="1" format="ascii">([\d ]+)<', text)
                notes = {name: "".join(map(chr, map(int, codes.split()[:-1]))) for name, codes in arrays}
            elif ending == "stl":
                notes = dict(note.split("=") for note in text[:80].rstrip("\0").split() if "=" in note)
            else:
                notes = dict(re.findall(r"^(?:comment|#) (\w+)=(\S+)$", text[:400], re.M))
            found[ending] = notes
        self.assertEqual((found.pop("off"), found.pop("npz")), ({}, {}))
        self.assertTrue(all(notes == found["ply"] for notes in found.values()), found)
        return found["ply"]

    def test_spaces_and_units(self):
        """As 3D Slicer writes and reads the space; where the input says nothing, nothing is said."""
        directions = "space directions: (-1,0,0) (0,-1,0) (0,0,1)\nspace origin: (0,0,0)\n"
        for space, is_in in (("left-posterior-superior", "LPS"), ("right-anterior-superior", "RAS"), ("LAS", "LAS")):
            self.assertEqual(self.notes(self.named(f"space: {space}\n{directions}")), {"SPACE": is_in})
        millimetres = f'space: LPS\n{directions}space units: "mm" "mm" "mm"\n'
        self.assertEqual(self.notes(self.named(millimetres)), {"SPACE": "LPS", "UNITS": "mm"})
        self.assertEqual(self.notes(self.named(millimetres), "--spacing", "2,2,2"), {"SPACE": "LPS"})
        self.assertEqual(self.report("info", self.path("named.nrrd"))["units"], "mm")
        self.assertIn("left-posterior-superior (LPS), in um",
                      self.expect(0, "info", self.named("space: left-posterior-superior\n" + directions +
                                                        'units: "um" "um" "um"\n')).stdout)
        for silent in ("", "space dimension: 3\n" + directions, 'units: "mm" "um" "mm"\n', "units: mm\n",
                       'units: "a b" "a b" "a b"\n', 'units: "<&" "<&" "<&"\n', f'units: "{"m" * 40}"\n'):
            self.assertEqual(self.notes(self.named(silent)), {}, silent)
        meta = self.write("a.mha", b"NDims = 3\nDimSize = 4 4 4\nElementType = MET_UCHAR\nAnatomicalOrientation = RAI\n"
                          b"DistanceUnits = mm\nElementDataFile = LOCAL\n" + bytes(n * 37 % 251 for n in range(64)))
        self.assertEqual(self.notes(meta), {"SPACE": "LPS", "UNITS": "mm"})
        self.assertEqual(self.notes(self.write_nifti("a.nii", 3, 1)), {"SPACE": "RAS", "UNITS": "um"})
        self.assertEqual(self.notes(self.write_nifti("a.nii", 0, 0)), {})
        self.expect(0, "tetrahedralize", meta, "--quiet", "-o", self.path("a.vtu"))
        with open(self.path("a.vtu"), "rb") as file:
            self.assertIn(b'Name="SPACE" NumberOfTuples="1" format="ascii">76 80 83 0<', file.read())

    def write_nifti(self, name, units, code):
        header = bytearray(352)
        struct.pack_into("<i", header, 0, 348)
        struct.pack_into("<8h", header, 40, 3, 4, 4, 4, 1, 1, 1, 1)
        struct.pack_into("<2h", header, 70, 2, 8)
        struct.pack_into("<8f", header, 76, 1, 1, 1, 1, 1, 1, 1, 1)
        struct.pack_into("<f", header, 108, 352)
        header[123] = units
        struct.pack_into("<2h", header, 252, 0, code)
        struct.pack_into("<12f", header, 280, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0)
        header[344:348] = b"n+1\0"
        return self.write(name, bytes(header) + bytes(n * 37 % 251 for n in range(64)))

    def test_what_formats_lack(self):
        self.refuses(2, "extract", self.volume, "--iso", "1", *REFERENCE, "-o", self.path("a.off"), "--carry", "x",
                     says="ply, vtp(,| or) npz")
        for ending in ("off",):
            said = self.expect(0, "extract", self.volume, "--iso", "127.5", *REFERENCE, "--normals", "-o",
                               self.path("a." + ending)).stderr
            self.assertIn("normals", said)


@tool_case.unittest.skipUnless(numpy, "Python has no numpy (Debian: python3-numpy)")
class Numpy(GridCase):
    def test_round_trip(self):
        """Every type and order as numpy saves it, against the same samples without a header."""
        shape, kinds = (7, 8, 9), ("u1", "i1", "u2", "i2", "u4", "i4", "f4", "f8", "u8", "i8", "?")
        flat = [(x * x + y * 3 + z * z * 2) % 101 for z, y, x in itertools.product(*map(range, shape))]
        want = None
        for kind, order, is_fortran in itertools.product(kinds, "<>", (False, True)):
            array = numpy.array(flat).reshape(shape) % (2 if kind == "?" else 128)
            array = array.astype(kind if kind == "?" else order + kind, order="F" if is_fortran else "C")
            numpy.save(self.path("a.npy"), array)
            done = self.expect(0, "extract", self.path("a.npy"), "--iso", "0.5" if kind == "?" else "50.25", "--json",
                               *REFERENCE)
            report = json.loads(done.stdout)
            self.assertEqual(report["dims"], [9, 8, 7])
            surface = report["surfaces"][0]
            got = (surface["vertices"], surface["triangles"], surface["bounds"])
            if kind != "?":
                want = want or got
                self.assertEqual(got, want, (kind, order, is_fortran))

    def test_frames_and_components(self):
        array = numpy.arange(2 * 5 * 6 * 7 * 3, dtype="f4").reshape(2, 5, 6, 7, 3)
        numpy.save(self.path("a.npy"), array)
        facts = json.loads(self.expect(0, "info", self.path("a.npy"), "--component", "1", "--frame", "1",
                                       "--json").stdout)
        self.assertEqual(facts["range"], [float(array[1, ..., 1].min()), float(array[1, ..., 1].max())])


if __name__ == "__main__":
    tool_case.main()
