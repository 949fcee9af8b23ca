#!/usr/bin/env python3
"""test_tool_failures.py TOOL [memory=LIBRARY] [layer=LIBRARY] [all] - the tool when memory or the device fails

Each command runs undisturbed, then once for every request for memory that the tool, the library and the libraries for
formats make (or every call of OpenCL), with that one failing: memory_fault.c is preloaded from LIBRARY, or layer.c
loaded. The tool then either does without, and what it writes is the same, byte for byte, or it ends with status 1 and a
message that names the failure; no file is left that is not whole, neither under its final name nor beside it. Never a
crash. Without `all` a sample of requests and calls. Standard library only.
"""
import base64
import bz2
import gzip
import os
import re
import struct
import subprocess
import sys
import tempfile
import time
import unittest
import zlib

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "common"))
from part import part_write

TOOL = None
MEMORY_LIBRARY = None
LAYER_LIBRARY = None
ALL = False
SIZE = 9
REQUESTS_MOST, CALLS_MOST = 8, 5  # of the sample
COUNTS = {"requests for memory failed, in the tool": 0, "calls of OpenCL failed, in the tool": 0}


def values():
    """Samples of a bump, x fastest."""
    axis = range(SIZE)
    return [round(100 - (x - 4) ** 2 - (y - 4) ** 2 - 2 * (z - 4) ** 2, 3) for z in axis for y in axis for x in axis]


def points():
    return [(x + 0.125 * y, y, z + 0.125 * x) for z in range(SIZE) for y in range(SIZE) for x in range(SIZE)]


def text(numbers):
    return " ".join(map(str, numbers)) + "\n"


def flat(triples):
    return [number for triple in triples for number in triple]


def hexahedra():
    row, plane = SIZE, SIZE * SIZE
    corners = (0, 1, 1 + row, row, plane, plane + 1, plane + 1 + row, plane + row)
    return [[x + row * y + plane * z + c for c in corners]
            for z in range(SIZE - 1) for y in range(SIZE - 1) for x in range(SIZE - 1)]


def legacy(dataset):
    return "# vtk DataFile Version 3.0\na bump\nASCII\n" + dataset


def point_data(count):
    return f"POINT_DATA {count}\nSCALARS bump float\nLOOKUP_TABLE default\n" + text(values())


def tiff(samples):
    """A page for each z, in one strip that is not packed: libtiff does not say that zlib had no memory."""
    out, size = bytearray(b"II*\0\x08\0\0\0"), SIZE * SIZE
    for n in range(SIZE):
        strip = struct.pack(f"<{size}f", *samples[n * size:(n + 1) * size])
        behind = len(out) + 2 + 12 * 10 + 4
        tags = {256: SIZE, 257: SIZE, 258: 32, 259: 1, 262: 1, 273: behind, 277: 1, 278: SIZE, 279: len(strip), 339: 3}
        out += struct.pack("<H", len(tags)) + b"".join(struct.pack("<HHII", tag, 4 if tag in (256, 257, 273, 278, 279)
                                                                   else 3, 1, value) for tag, value in tags.items())
        out += struct.pack("<I", behind + len(strip) if n + 1 < SIZE else 0) + strip
    return bytes(out)


def inputs_write(folder):
    """Files of every family of formats."""
    count, cells = SIZE ** 3, hexahedra()
    dims = f"{SIZE} {SIZE} {SIZE}"
    extent = f"0 {SIZE - 1} 0 {SIZE - 1} 0 {SIZE - 1}"
    nrrd = f"NRRD0004\ntype: float\ndimension: 3\nsizes: {dims}\nendian: little\nencoding: "
    scalars = f'<PointData><DataArray type="Float32" Name="bump" format="ascii">{text(values())}</DataArray></PointData>'
    places = ('<Points><DataArray type="Float32" NumberOfComponents="3" format="ascii">' + text(flat(points())) +
              "</DataArray></Points>")
    files = {
        "a.nrrd": nrrd + "ascii\n\n" + text(values()),
        "points.vtk": legacy(f"DATASET STRUCTURED_POINTS\nDIMENSIONS {dims}\nORIGIN 0 0 0\nSPACING 1 1 1\n" +
                             f"CELL_DATA {len(cells)}\nSCALARS bump float\nLOOKUP_TABLE default\n" +
                             text(values()[:len(cells)])),
        "bare.vtk": legacy("DATASET STRUCTURED_POINTS\nDIMENSIONS 3 4 5\nORIGIN 0 0 0\nSPACING 1 1 1\n"),
        "grid.vtk": legacy(f"DATASET STRUCTURED_GRID\nDIMENSIONS {dims}\nPOINTS {count} float\n" + text(flat(points())) +
                           point_data(count)),
        "cells.vtk": legacy(f"DATASET UNSTRUCTURED_GRID\nPOINTS {count} float\n" + text(flat(points())) +
                            f"CELLS {len(cells)} {9 * len(cells)}\n" + "".join(text([8] + c) for c in cells) +
                            f"CELL_TYPES {len(cells)}\n" + text([12] * len(cells)) + point_data(count)),
        "grid.vts": f'<VTKFile type="StructuredGrid" version="0.1" byte_order="LittleEndian"><StructuredGrid '
                    f'WholeExtent="{extent}"><Piece Extent="{extent}">{scalars}{places}</Piece></StructuredGrid></VTKFile>',
        "a.xyz": f"1\n{dims}\n" + "".join(text(p[axis] for p in points()) for axis in range(3)),
        "a.q": f"1\n{dims}\n0.5 0 1000 0\n" + text([v / 50 for v in values()] * 5),
    }
    for name, content in files.items():
        with open(os.path.join(folder, name), "w") as out:
            out.write(content)
    raw = struct.pack(f"<{count}f", *values())
    nifti = struct.pack("<i36x8h14xhh2x8f3f224xi", 348, 3, SIZE, SIZE, SIZE, 1, 1, 1, 1, 16, 32, *[1] * 8, 352, 1, 0,
                        int.from_bytes(b"n+1\0", "little")) + bytes(4)
    packed = zlib.compress(raw)
    block = base64.b64encode(struct.pack("<4I", 1, len(raw), 0, len(packed))) + base64.b64encode(packed)
    packed_files = {
        "b.nrrd": (nrrd + "gzip\n\n").encode() + gzip.compress(raw),
        "c.nrrd": (nrrd + "bzip2\n\n").encode() + bz2.compress(raw),
        "a.nii": nifti + raw,
        "a.nii.gz": gzip.compress(nifti + raw),
        "a.mhd": f"NDims = 3\nDimSize = {dims}\nElementType = MET_FLOAT\nCompressedData = True\n"
                 "ElementDataFile = a.zraw\n".encode(),
        "a.zraw": packed,
        "a.vtk.gz": gzip.compress(files["grid.vtk"].encode()),
        "a.npy": b"\x93NUMPY\1\0" + struct.pack("<H", 118) + (
            f"{{'descr': '>f4', 'fortran_order': True, 'shape': ({SIZE}, {SIZE}, {SIZE}), }}".ljust(117) + "\n").encode()
                 + struct.pack(f">{count}f", *values()),
        "labels.npy": b"\x93NUMPY\1\0" + struct.pack("<H", 118) + (
            f"{{'descr': '|u1', 'fortran_order': False, 'shape': ({SIZE}, {SIZE}, {SIZE}), }}".ljust(117) + "\n").encode()
                      + bytes(0 if v < 80 else 1 if v < 90 else 2 for v in values()),
        "a.tif": tiff(values()),
        "a.vti": f'<VTKFile type="ImageData" version="0.1" byte_order="LittleEndian" '
                 f'compressor="vtkZLibDataCompressor"><ImageData WholeExtent="{extent}"><Piece Extent="{extent}">'
                 '<PointData><DataArray type="Float32" Name="bump" format="binary">'.encode() + block +
                 b"</DataArray></PointData></Piece></ImageData></VTKFile>",
    }
    for name, content in packed_files.items():
        with open(os.path.join(folder, name), "wb") as out:
            out.write(content)


class Failures(unittest.TestCase):
    def setUp(self):
        holder = tempfile.TemporaryDirectory(prefix="tetracubes-failures-")
        self.addCleanup(holder.cleanup)
        self.folder = holder.name
        self.outputs = os.path.join(self.folder, "outputs")
        os.mkdir(self.outputs)
        inputs_write(self.folder)

    def run_once(self, command, environment):
        """Status, messages and the files written, by name, info's output among them; these are gone afterwards."""
        words = [os.path.join(self.folder, w[1:]) if w.startswith("@") else w for w in command]
        result = subprocess.run([TOOL, *words], cwd=self.outputs, env=dict(os.environ, **environment), timeout=600,
                                stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        files = {}
        for name in os.listdir(self.outputs):
            with open(os.path.join(self.outputs, name), "rb") as file:
                files[name] = file.read()
            os.unlink(os.path.join(self.outputs, name))
        if command[0] == "info" and result.returncode == 0:
            files["standard output"] = result.stdout
        return result.returncode, result.stderr, files

    def judge(self, command, what, outcome, expected, pattern):
        """The run did without what failed, or it failed as it should."""
        status, messages, files = outcome
        told = f"{command}, {what}: status {status}, {messages!r}"
        self.assertIn(status, (0, 1), told)
        if status == 0:
            self.assertEqual(files, expected, told + ": the files differ")
            return
        for name in files:  # of several surfaces, those before the failure
            self.assertEqual(files[name], expected.get(name), f"{told}: {name} is left")
        self.assertRegex(messages, r"(?m)^tetracubes: .*" + pattern, told)

    def sample(self, count, most):
        step = 1 if ALL or count <= most else count // most
        return range(1, count + 1, step)

    def fail_requests(self, *command, most=REQUESTS_MOST):
        clean = {"LD_PRELOAD": MEMORY_LIBRARY, "TETRACUBES_MEMORY_FAULT": "0"}
        status, messages, files = self.run_once(command, clean)
        self.assertEqual(status, 0, f"{command}: {messages}")
        requests, left = map(int, re.search(r"memory_fault: (\d+) requests, 0 failed, (\d+) pieces", messages).groups())
        self.assertEqual(left, 0, f"{command}: memory is left at the end")
        for n in self.sample(requests, most):
            outcome = self.run_once(command, dict(clean, TETRACUBES_MEMORY_FAULT=str(n)))
            COUNTS["requests for memory failed, in the tool"] += 1
            self.judge(command, f"request {n}", outcome, files, "memory")
            self.assertRegex(outcome[1], r"memory_fault: \d+ requests, 1 failed, 0 pieces",
                             f"{command}, request {n}: memory is left: {outcome[1]!r}")

    def fail_calls(self, *command):
        clean = {"OPENCL_LAYERS": LAYER_LIBRARY, "TETRACUBES_LAYER": "count",
                 "TETRACUBES_CACHE_DIR": os.path.join(self.folder, "programs")}
        self.run_once(command, clean)  # puts kernels into caches
        status, messages, files = self.run_once(command, clean)
        self.assertEqual(status, 0, f"{command}: {messages}")
        calls = {name: int(count) for name, count in re.findall(r"layer: (cl\w+) (\d+)", messages)}
        self.assertTrue(calls, "the layer was not loaded")
        for place, (name, count) in enumerate(calls.items()):
            chosen = range(1, count + 1) if ALL else [1 + place % count]
            for n in chosen:
                outcome = self.run_once(command, dict(clean, TETRACUBES_LAYER=f"fail {name} {n} -5"))
                COUNTS["calls of OpenCL failed, in the tool"] += 1
                self.judge(command, f"{name} {n}", outcome, files, r".*-5\b")


@unittest.skipUnless(sys.platform == "linux", "preloads")
class Memory(Failures):
    def setUp(self):
        if not MEMORY_LIBRARY:
            self.skipTest("no memory_fault given")
        super().setUp()

    def test_formats(self):
        for inputs in (["@a.nrrd"], ["@b.nrrd"], ["@c.nrrd"], ["@a.nii"], ["@a.nii.gz"], ["@a.mhd"], ["@a.vti"],
                       ["@points.vtk"], ["@grid.vtk"], ["@a.vtk.gz"], ["@a.npy"], ["@a.tif"], ["@cells.vtk"], ["@grid.vts"],
                       ["@a.xyz", "@a.q", "--field", "density"]):
            iso = "1.5" if "@a.q" in inputs else "80"
            with self.subTest(inputs):
                self.fail_requests("extract", *inputs, "--iso", iso, "--engine", "reference", "-o", "s.ply")

    def test_outputs(self):
        for ending in ("vtp", "stl", "obj", "off", "glb", "html", "npz"):
            with self.subTest(ending):
                self.fail_requests("extract", "@grid.vtk", "--iso", "80,90", "--engine", "reference", "--normals",
                                   "--check", "-o", f"s%.{ending}")

    def test_streams_and_parts(self):
        """All requests of the first one, as few are the stream's own."""
        extract = ["extract", "@a.nrrd", "--iso", "80", "--engine", "reference"]
        self.fail_requests(*extract, "--stream", "-o", "s.stl", most=1000)
        self.fail_requests("extract", "@grid.vts", "--iso", "80", "--engine", "reference", "--stream", "--carry", "bump",
                           "-o", "s.vtp")
        self.fail_requests(*extract, "--part", "0/2", "-o", "s.part")

    def test_labels_and_intervals(self):
        self.fail_requests("labels", "@labels.npy", "--engine", "reference", "--check", "--separate", "-o", "s%.ply")
        self.fail_requests("labels", "@labels.npy", "--engine", "reference", "-o", "s.glb")
        self.fail_requests("isovolume", "@a.nrrd", "--range", "80,90", "--engine", "reference", "--check", "-o", "s.vtu")

    def test_pictures(self):
        if "pictures: PNG" not in subprocess.check_output([TOOL, "--version"], text=True):
            self.skipTest("built without libpng")
        size = ["--preview-size", "40,30"]
        self.fail_requests("extract", "@a.nrrd", "--iso", "80,90", "--engine", "reference", "-o", "s%.ply", "--preview",
                           "s%.png", *size)
        self.fail_requests("info", "@a.nrrd", "--iso", "80", "--preview", "s.png", *size)

    def test_other_commands(self):
        self.fail_requests("tetrahedralize", "@cells.vtk", "-o", "s.vtu")
        self.fail_requests("tetrahedralize", "@bare.vtk", "-o", "s.vtu")
        self.fail_requests("info", "@grid.vtk")
        self.fail_requests("info", "@grid.vtk", "--json")
        self.fail_requests("extract", "@a.nrrd", "--iso", "80", "--engine", "reference", "--check", "--json")
        self.fail_requests("extract", "@a.nrrd", "--iso", "999", "--nodata", "-7", "--engine", "reference", "--json")
        self.fail_requests("extract", "@a.nrrd", "--iso", "91", "--engine", "reference", "--drop-degenerate", "--normals",
                           "-o", "s.ply")
        self.fail_requests("extract", "@grid.vts", "--iso", "91", "--engine", "reference", "--drop-degenerate", "--carry",
                           "bump", "-o", "s.vtp")
        if "simplifies: meshoptimizer" in subprocess.check_output([TOOL, "--version"], text=True):
            self.fail_requests("extract", "@a.nrrd", "--iso", "80", "--engine", "reference", "--simplify", "0.3",
                               "--simplify-error", "0.2", "--normals", "-o", "s.ply")
        self.fail_requests("devices", "--json")
        self.fail_requests("generate", "sphere", "--dims", "9,9,9", "--type", "u8", "-o", "s.nrrd")
        self.fail_requests("extract", "@grid.vts", "--iso", "80", "--engine", "reference", "--carry", "bump", "-o",
                           "s.vtp")


class Device(Failures):
    def setUp(self):
        if not LAYER_LIBRARY:
            self.skipTest("no layer given")
        super().setUp()

    def test_extraction(self):
        self.fail_calls("extract", "@a.nrrd", "--iso", "80,90", "-o", "s%.ply")

    def test_cells(self):
        self.fail_calls("extract", "@cells.vtk", "--iso", "80", "--verify", "-o", "s.vtp")

    def test_devices(self):
        self.fail_calls("devices")


def results_write(start, result):
    figures = {**COUNTS, "wrong statuses, files or messages, in the tool": len(result.failures) + len(result.errors)}
    version = subprocess.check_output([TOOL, "--version"], text=True).split()[1]
    part_write("tool_failures", {"tetracubes": version}, figures.items(), time.monotonic() - start)


if __name__ == "__main__":
    begin = time.monotonic()
    for word in sys.argv[2:]:
        MEMORY_LIBRARY = word[7:] if word.startswith("memory=") else MEMORY_LIBRARY
        LAYER_LIBRARY = word[6:] if word.startswith("layer=") else LAYER_LIBRARY
        ALL = ALL or word == "all"
    TOOL = os.path.abspath(sys.argv[1])
    done = unittest.main(argv=sys.argv[:1], verbosity=2, exit=False).result
    print(COUNTS)
    if ALL:
        results_write(begin, done)
    sys.exit(not done.wasSuccessful())
