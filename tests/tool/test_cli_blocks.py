#!/usr/bin/env python3
"""test_cli_blocks.py TOOL [reference] - the command line on grids of several blocks: joined or apart, fields carried"""
import math
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "common"))
import tool_case
from grid_files import bump, lattice, vti_text
from meshes import ply_vertices
from tool_case import GridCase


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

    def test_flat_blocks_are_skipped(self):
        flat = ((4, 4, 1), lattice((4, 4, 1)), list(map(bump, lattice((4, 4, 1)))))
        [whole] = self.report("extract", *self.inputs, "--field", "density", "--iso", "0.5", "--engine",
                              "reference")["surfaces"]
        inputs = self.write_plot3d("f", [flat] + self.blocks)
        report, surface = self.surface(*inputs, "--field", "density", "--iso", "0.5")
        self.assertEqual((report["cells"], surface["hash"]), (449, whole["hash"]))
        self.assertRegex(self.expect(0, "extract", *inputs, "--field", "density", "--iso", "0.5", "--engine",
                                     "reference").stderr, "1 blocks of one point along an axis are skipped")
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
