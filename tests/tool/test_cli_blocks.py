#!/usr/bin/env python3
"""test_cli_blocks.py TOOL [reference] - the command line on grids of several blocks: joined or apart, fields carried"""
import array
import math
import os
import resource
import struct
import subprocess
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "common"))
import tool_case
from grid_files import bump, lattice, vti_text
from meshes import ply_vertices
from tool_case import GridCase


def plot3d_noise(block_count, size, path, density_path):
    """Grid and solution of cubes of size^3 points, in one file each, whose surfaces go through nearly all cells."""
    def record(file, content):
        mark = struct.pack("<i", len(content))
        file.write(mark + content + mark)
    places = lattice((size, size, size))
    head = struct.pack(f"<{3 * block_count}i", *[size] * 3 * block_count)
    density = array.array("f", [(n * 2654435761 >> 7) % 1000 / 1000 for n in range(len(places))]).tobytes()
    with open(path, "wb") as grid, open(density_path, "wb") as solution:
        for file in (grid, solution):
            record(file, struct.pack("<i", block_count))
            record(file, head)
        for block in range(block_count):
            shifts = (0, 0, block * size)
            record(grid, b"".join(array.array("f", [p[axis] + shifts[axis] for p in places]).tobytes()
                                  for axis in range(3)))
            record(solution, struct.pack("<4f", 0.5, 0, 100, 0))
            record(solution, density + bytes(4 * len(density)))


def peak_memory(*arguments):
    """(exit status, most resident bytes) of a run of the tool."""
    child = subprocess.Popen([tool_case.TOOL, *arguments], stdout=subprocess.DEVNULL)
    _, status, usage = os.wait4(child.pid, 0)
    child.returncode = os.waitstatus_to_exitcode(status)
    return child.returncode, 1024 * usage.ru_maxrss


class Blocks(GridCase):
    def setUp(self):
        super().setUp()
        self.blocks = []
        for n, dims in enumerate(((6, 8, 9), (4, 8, 9), (2, 2, 2))):
            points = lattice(dims, (5 * n, 0, 0))
            self.blocks.append((dims, points, list(map(bump, points))))
        self.inputs = self.write_plot3d("a", self.blocks)

    def test_joined(self):
        report, surface = self.surface(*self.inputs, "--field", "density", "--iso", "0.5", "-o", self.path("all.ply"))
        self.assertIsNone(report["dims"])
        self.assertEqual((report["cells"], report["tetrahedra"]), (280 + 168 + 1, 5 * 449))
        parts = []
        for n, block in enumerate(self.blocks):
            single = self.write_plot3d(f"b{n}", [block])
            parts.append(self.surface(*single, "--field", "density", "--iso", "0.5")[1])
        self.assertGreater(min(part["triangles"] for part in parts[:2]), 0)
        self.assertEqual(parts[2]["triangles"], 0)
        for key in ("vertices", "triangles", "active_cells", "boundary_edges", "components"):
            self.assertEqual(surface[key], sum(part[key] for part in parts), key)
        vertices, faces = ply_vertices(self.path("all.ply"))
        self.assertEqual((len(vertices), len(faces)), (surface["vertices"], surface["triangles"]))
        [counted] = self.report("extract", *self.inputs, "--field", "density", "--iso", "0.5", "--count", "--engine",
                                "reference")["surfaces"]
        self.assertEqual((counted["vertices"], counted["triangles"]), (surface["vertices"], surface["triangles"]))

    def test_separate(self):
        extract = ["extract", *self.inputs, "--field", "density", "--iso", "0.5,2", "--engine", "reference"]
        self.expect(0, *extract, "-o", self.path("joined-%.ply"))
        text = self.expect(0, *extract, "-o", self.path("s.x-%.ply"), "--blocks", "separate").stdout
        self.assertIn("s.x-0.5_b0.ply to ", text)
        for iso in ("0.5", "2"):
            whole, whole_faces = ply_vertices(self.path(f"joined-{iso}.ply"))
            vertices, faces = [], []
            for n in range(3):
                part, part_faces = ply_vertices(self.path(f"s.x-{iso}_b{n}.ply"))
                faces += [tuple(len(vertices) + corner for corner in face) for face in part_faces]
                vertices += part
            self.assertEqual((vertices, faces), (whole, whole_faces))
        self.assertEqual(len([name for name in self.files() if "_b" in name]), 6)

    def test_grid_alone(self):
        self.refuses(4, "extract", self.inputs[0], "--iso", "1", says="values are in its solution: name both files")

    def test_separate_has_the_figures_of_joined(self):
        for more in ([], ["--drop-degenerate"], ["--soup"], ["--normals", "--carry", "momentum-x"]):
            extract = ["extract", *self.inputs, "--field", "density", "--iso", "0.5", "--engine", "reference", "--check",
                       *more, "-o", self.path("a.ply")]
            [joined] = self.report(*extract)["surfaces"]
            report = self.report(*extract, "--blocks", "separate")
            [separate] = report["surfaces"]
            for surface in (joined, separate):
                del surface["timings_ms"]
                for key in "area", "volume":
                    surface[key] = surface[key] and round(surface[key], 9)
            self.assertNotEqual(separate.pop("hash"), joined.pop("hash"))  # of numbers that begin anew
            self.assertEqual(separate.pop("outputs"), [self.path(f"a_b{n}.ply") for n in range(3)])
            self.assertEqual(separate, {key: joined[key] for key in joined if key != "output"})
            self.assertEqual(report["notices"], self.report(*extract)["notices"])

    def test_separate_keeps_one_block(self):
        """Blocks are written as they are extracted: no two surfaces are in memory."""
        inputs = [self.path("n.xyz"), self.path("n.q")]
        plot3d_noise(16, 28, *inputs)
        peaks = {}
        for blocks in "joined", "separate":
            status, peaks[blocks] = peak_memory("extract", *inputs, "--field", "density", "--iso", "0.5", "--engine",
                                                "reference", "--quiet", "--blocks", blocks, "-o", self.path("n.ply"))
            self.assertEqual(status, 0)
        mesh = os.path.getsize(self.path("n.ply"))
        self.assertGreater(mesh, 20 << 20)
        self.assertLess(peaks["separate"], peaks["joined"] - mesh // 2)

    def test_separate_appears_whole_or_not_at_all(self):
        """The second block's file is too large for the system: the first one's does not appear either."""
        small, large = ((dims, lattice(dims), list(map(bump, lattice(dims)))) for dims in ((4, 4, 4), (12, 12, 12)))
        inputs = self.write_plot3d("w", [small, large])
        with open(self.path("w_b0.ply"), "wb") as before:
            before.write(b"as it was")
        sizes = resource.getrlimit(resource.RLIMIT_FSIZE)
        resource.setrlimit(resource.RLIMIT_FSIZE, (8192, sizes[1]))
        try:
            self.refuses(1, "extract", *inputs, "--field", "density", "--iso", "0.5", "--engine", "reference", "--blocks",
                         "separate", "-o", self.path("w.ply"), says="w_b1.ply: cannot be written")
        finally:
            resource.setrlimit(resource.RLIMIT_FSIZE, sizes)
        self.expect(0, "extract", *inputs, "--field", "density", "--iso", "0.5", "--engine", "reference", "--blocks",
                    "separate", "-o", self.path("w.ply"))
        self.assertLess(os.path.getsize(self.path("w_b0.ply")), 8192)
        self.assertGreater(os.path.getsize(self.path("w_b1.ply")), 8192)

    def test_separate_of_more_blocks_than_files_may_be_open(self):
        dims, most = (2, 2, 2), 64
        inputs = self.write_plot3d("m", [(dims, lattice(dims), [0.0, 1.0] * 4)] * (2 * most))
        files = resource.getrlimit(resource.RLIMIT_NOFILE)
        resource.setrlimit(resource.RLIMIT_NOFILE, (most, files[1]))
        try:
            self.expect(0, "extract", *inputs, "--field", "density", "--iso", "0.5", "--engine", "reference", "--blocks",
                        "separate", "-o", self.path("m.ply"))
        finally:
            resource.setrlimit(resource.RLIMIT_NOFILE, files)
        self.assertEqual(len([name for name in self.files() if name.startswith("m_b")]), 2 * most)

    def test_flat_blocks_are_skipped(self):
        flat = ((4, 4, 1), lattice((4, 4, 1)), list(map(bump, lattice((4, 4, 1)))))
        [whole] = self.report("extract", *self.inputs, "--field", "density", "--iso", "0.5", "--engine",
                              "reference")["surfaces"]
        inputs = self.write_plot3d("f", [flat] + self.blocks)
        report, surface = self.surface(*inputs, "--field", "density", "--iso", "0.5")
        self.assertEqual((report["cells"], surface["hash"]), (449, whole["hash"]))
        self.assertRegex(self.expect(0, "extract", *inputs, "--field", "density", "--iso", "0.5", "--engine",
                                     "reference").stderr, "1 block of one point along an axis: skipped")
        for blocks in ([flat], [flat, flat]):
            inputs = self.write_plot3d("g", blocks)
            self.refuses(4, "extract", *inputs, "--field", "density", "--iso", "0.5", "--engine", "reference")

    def test_separate_never_overwrites_the_input(self):
        os.rename(self.inputs[1], self.path("s_b1.ply"))
        self.expect(2, "extract", self.inputs[0], self.path("s_b1.ply"), "--field", "density", "--iso", "0.5",
                    "--engine", "reference", "--blocks", "separate", "-o", self.path("s.ply"), says="input itself")

    def test_normals_and_soup(self):
        _, surface = self.surface(*self.inputs, "--field", "density", "--iso", "0.5", "--normals", "--soup", "-o",
                                  self.path("a.ply"))
        vertices, faces = ply_vertices(self.path("a.ply"))
        self.assertEqual(len(vertices), 3 * surface["triangles"])
        for v in vertices:
            self.assertAlmostEqual(v["nx"] ** 2 + v["ny"] ** 2 + v["nz"] ** 2, 1, places=5)
            outward = [v[axis] - centre for axis, centre in zip("xyz", (4.3, 3.6, 4.1))]
            self.assertGreater(sum(a * v["n" + axis] for a, axis in zip(outward, "xyz")), 0)

    def test_carry(self):
        _, surface = self.surface(*self.inputs, "--field", "density", "--iso", "0.5", "--carry", "momentum-x,energy",
                                  "-o", self.path("a.ply"))
        vertices, _ = ply_vertices(self.path("a.ply"))
        self.assertEqual(len(vertices), surface["vertices"])
        for vertex in vertices:
            self.assertAlmostEqual(vertex["momentum_x"], vertex["x"], places=4)
            self.assertEqual(vertex["energy"], 2.5)

    def test_carry_where_the_surface_meets_samples(self):
        """Where a vertex lies on a sample, what is missing at the other end of the edge plays no part."""
        self.needs_xml()
        points = lattice((3, 2, 2))
        volume = self.write("a.vti", vti_text((3, 2, 2), [
            ("f", "f32", [float(p[0] == 1) for p in points]),
            ("k", "f32", [5.0 if p[0] == 1 else math.nan for p in points])]))
        self.surface(volume, "--field", "f", "--iso", "1", "--carry", "k", "-o", self.path("a.ply"))
        vertices, _ = ply_vertices(self.path("a.ply"))
        self.assertGreater(len(vertices), 7)
        self.assertEqual({vertex["k"] for vertex in vertices}, {5.0})

    def test_carry_of_several_components(self):
        self.needs_xml()
        points = lattice((4, 3, 3))
        places = [float(n) for p in points for n in p]
        volume = self.write("a.vti", vti_text((4, 3, 3), [
            ("f", "f32", [float(sum(p)) for p in points]), ("place", "f32", places, 3)]))
        self.surface(volume, "--field", "f", "--iso", "2.5", "--carry", "place,f", "-o", self.path("a.ply"))
        vertices, _ = ply_vertices(self.path("a.ply"))
        self.assertGreater(len(vertices), 7)
        for vertex in vertices:
            self.assertAlmostEqual(vertex["f"], 2.5, places=6)
            for axis, name in enumerate("xyz"):
                self.assertAlmostEqual(vertex[f"place_{axis}"], vertex[name], places=6)

    def test_carry_to_separate_files(self):
        self.expect(0, "extract", *self.inputs, "--field", "density", "--iso", "0.5", "--engine", "reference",
                    "--carry", "momentum-x", "--blocks", "separate", "-o", self.path("a.ply"))
        for n in range(2):
            vertices, _ = ply_vertices(self.path(f"a_b{n}.ply"))
            self.assertGreater(len(vertices), 0)
            for vertex in vertices:
                self.assertAlmostEqual(vertex["momentum_x"], vertex["x"], places=4)


if __name__ == "__main__":
    tool_case.main()
