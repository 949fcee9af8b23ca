#!/usr/bin/env python3
"""test_cli_grids.py TOOL [reference] - the command line on structured grids beyond the uniform image

Writes small grids itself (Plot3D and VTK XML, as text) and runs the tool on them: the choice of a field, averages of
cells, curvilinear and rectilinear grids, blanking.
"""
import json
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "common"))
import tool_case
from grid_files import bump, data_array, lattice, structured_text, vti_text, vts_text
from meshes import ply_vertices
from tool_case import GridCase, counts


class Usage(GridCase):
    def test_numbers_of_inputs(self):
        for command in (["extract", "--iso", "1"], ["info"], ["tetrahedralize", "-o", self.path("a.vtu")]):
            self.refuses(2, *command, "a.xyz", "b.q", "c.q", says="c.q")
            self.refuses(2, *command, "a.raw", "b.raw", "--dims", "2,2,2", "--type", "u8", says="b.raw")
            self.refuses(2, *command, "a.nrrd", "b.nrrd", says="b.nrrd")
            self.refuses(2, *command, "a.vtu", "b.vtu", says="b.vtu")
            self.refuses(2, *command, says="input")
            self.refuses(4, *command, self.path("none.xyz"), self.path("none.q"), says="none.xyz")

    def test_combinations(self):
        self.refuses(2, "extract", "x.nrrd", "--iso", "1", "--carry", "a", says="-o FILE")
        self.refuses(2, "extract", "x.nrrd", "--iso", "1", "--blocks", "separate", says="-o FILE")
        self.refuses(2, "extract", "x.nrrd", "--iso", "1", "--blocks", "both", says="joined, separate")
        self.refuses(2, "extract", "x.nrrd", "--iso", "1", "--count", "--carry", "a", says="--count")
        for ending in ("stl", "obj"):
            self.refuses(2, "extract", "x.nrrd", "--iso", "1", "--carry", "a", "-o", self.path(f"a.{ending}"),
                         says=ending)
        self.refuses(2, "tetrahedralize", "x.nrrd", says="-o FILE")
        self.refuses(2, "tetrahedralize", "x.nrrd", "-o", self.path("a.vtp"), says="vtu")

    def test_formats_that_are_not_read(self):
        for name, content, says in (("a.ex2", b"CDF\1", "Exodus"), ("a.cgns", b"?", "CGNS"),
                                    ("a.obj", b"v 0 0 0", "surface"), ("a", b"?", "not known")):
            with open(self.path(name), "wb") as f:
                f.write(content)
            for command in (["info"], ["extract", "--iso", "1"]):
                result = self.refuses(4, *command, self.path(name), says=says)
                self.assertRegex(result.stderr, r"reads raw, NRRD.*Plot3D")


class Choice(GridCase):
    def setUp(self):
        super().setUp()
        dims = (6, 5, 4)
        points = lattice(dims)
        self.inputs = self.write_plot3d("a", [(dims, points, [float(p[0] + p[1]) for p in points])])

    def test_open_choice_lists_the_fields(self):
        for fields in ([], ["--field", "Density"]):
            result = self.refuses(2, "extract", *self.inputs, "--iso", "1.5", *fields)
            for name in ("density", "momentum-x", "momentum-z", "energy", "pressure"):
                self.assertIn(f"{name} (point)", result.stderr)
        self.refuses(2, "extract", *self.inputs, "--iso", "1.5", "--field", "density", "--component", "1",
                     says="--component 1")
        self.refuses(2, "extract", *self.inputs, "--iso", "1.5", "--field", "density", "--carry", "energy,none", "-o",
                     self.path("a.ply"), says="none")
        self.refuses(2, "extract", *self.inputs, "--iso", "1.5", "--field", "density", "--carry", "energy,energy", "-o",
                     self.path("a.ply"), says="twice")
        self.refuses(2, "info", *self.inputs, "--field", "no", says="density")

    def test_frames(self):
        self.needs_xml()
        image = self.write("f.vti", vti_text((2, 2, 2), [("f", "f32", [float(n) for n in range(8)])]))
        for inputs in (self.inputs, self.inputs[:1], [image]):
            self.refuses(2, "info", *inputs, "--frame", "1", says="has one frame; leave out --frame")
            self.expect(0, "info", *inputs, "--frame", "0")

    def test_output_is_an_input(self):
        os.rename(self.inputs[1], self.path("q.ply"))
        self.refuses(2, "extract", self.inputs[0], self.path("q.ply"), "--iso", "1", "--field", "density", "-o",
                     self.path("q.ply"), says="input itself")

    def test_components(self):
        self.needs_xml()
        points = lattice((4, 4, 4))
        vectors = [float(n) for p in points for n in p]
        volume = self.write("a.vti", vti_text((4, 4, 4), [("v", "f32", vectors, 3)]))
        self.refuses(2, "extract", volume, "--iso", "0.5", says="3 components.*--component")
        for axis in range(3):
            report, surface = self.surface(volume, "--iso", "0.5", "--component", axis)
            self.assertEqual([corner[axis] for corner in surface["bounds"]], [0.5, 0.5])
        self.refuses(2, "extract", volume, "--iso", "0.5", "--component", "3", says="--component 3")
        self.assertIsNone(self.report("info", volume)["histogram"]["counts"] or None)
        self.assertEqual(self.report("info", volume, "--component", "1")["range"], [0, 3])

    def test_cells_are_averaged(self):
        self.needs_xml()
        values = [float(x * x + 3 * y - z) for x, y, z in lattice((4, 3, 2))]
        volume = self.write("c.vti", vti_text((5, 4, 3), (), [("c", "f32", values)]))
        means = []
        for x, y, z in lattice((5, 4, 3)):
            around = [values[a + 4 * (b + 3 * c)] for a, b, c in lattice((4, 3, 2))
                      if x - 1 <= a <= x and y - 1 <= b <= y and z - 1 <= c <= z]
            means.append(sum(around) / len(around))
        same = self.write("p.vti", vti_text((5, 4, 3), [("p", "f32", means)]))
        result = self.expect(0, "extract", volume, "--iso", "4.1", "--engine", "reference", "--json")
        self.assertRegex(result.stderr, "'c' is of cells: averaged")
        [of_cells] = json.loads(result.stdout)["surfaces"]
        [of_points] = self.report("extract", same, "--iso", "4.1", "--engine", "reference")["surfaces"]
        self.assertEqual(of_cells["hash"], of_points["hash"])
        self.assertGreater(of_cells["triangles"], 10)
        quiet = self.expect(0, "extract", volume, "--iso", "4.1", "--engine", "reference", "--quiet")
        self.assertEqual((quiet.stdout, quiet.stderr), ("", ""))


    def test_points_and_cells_of_one_name(self):
        self.needs_xml()
        of_points = [float(p[0]) for p in lattice((4, 3, 3))]
        of_cells = [float(p[1]) for p in lattice((3, 2, 2))]
        both = self.write("b.vti", vti_text((4, 3, 3), [("t", "f32", of_points), ("u", "f32", of_points)],
                                            [("t", "f32", of_cells)]))
        how = ["--iso", "0.3"]
        for name, axis in (("t", 0), ("point:t", 0), ("cell:t", 1)):
            _, surface = self.surface(both, "--field", name, *how)
            low, high = surface["bounds"]
            self.assertEqual([a == b for a, b in zip(low, high)], [n == axis for n in range(3)], name)
        result = self.refuses(2, "extract", both, "--field", "cell:u", *how, says="'cell:u'")
        self.assertIn("t (point), cell:t (cell), u (point)", result.stderr)
        self.surface(both, "--field", "u", *how, "--carry", "cell:t,t", "-o", self.path("a.ply"))
        vertices, _ = ply_vertices(self.path("a.ply"))
        for vertex in vertices:
            self.assertAlmostEqual(vertex["t"], 0.3, places=6)
            self.assertAlmostEqual(vertex["cell_t"], vertex["y"] / 2, places=6)
        named = self.write("n.vti", vti_text((4, 3, 3), [("cell:t", "f32", of_points)], [("t", "f32", of_cells)]))
        _, surface = self.surface(named, "--field", "cell:t", *how)
        self.assertEqual(surface["bounds"][0][0], surface["bounds"][1][0])


class Structured(GridCase):
    dims = (9, 8, 9)

    def image(self):
        """The same samples as a uniform image."""
        return self.raw("image.raw", "f32", self.dims, list(map(bump, lattice(self.dims))))

    def test_curvilinear_as_uniform(self):
        points = lattice(self.dims)
        inputs = self.write_plot3d("a", [(self.dims, points, list(map(bump, points)))])
        report, surface = self.surface(*inputs, "--field", "density", "--iso", "0.5")
        self.assertEqual((report["dims"], report["cells"], report["tetrahedra"]), ([9, 8, 9], 448, 2240))
        _, uniform = self.surface(*self.image(), "--iso", "0.5")
        self.assertEqual(counts(surface), counts(uniform))
        self.assertAlmostEqual(surface["volume"], uniform["volume"], places=3)

    def test_stretched(self):
        points = [(2.0 * x, y - 0.25 * x, 3.0 * z + 1) for x, y, z in lattice(self.dims)]
        inputs = self.write_plot3d("a", [(self.dims, points, list(map(bump, lattice(self.dims))))])
        _, surface = self.surface(*inputs, "--field", "density", "--iso", "0.5")
        _, uniform = self.surface(*self.image(), "--iso", "0.5")
        self.assertEqual(counts(surface), counts(uniform))
        self.assertAlmostEqual(surface["volume"], 6 * uniform["volume"], places=2)
        mirrored = self.write_plot3d("m", [(self.dims, [(-x, y, z) for x, y, z in points],
                                            list(map(bump, lattice(self.dims))))])
        _, other = self.surface(*mirrored, "--field", "density", "--iso", "0.5")
        self.assertAlmostEqual(surface["volume"], other["volume"], places=3)

    def test_hybrid(self):
        points = lattice(self.dims)
        inputs = self.write_plot3d("a", [(self.dims, points, list(map(bump, points)))])
        _, tetra = self.surface(*inputs, "--field", "density", "--iso", "0.5")
        report, hybrid = self.surface(*inputs, "--field", "density", "--iso", "0.5", "--method", "hybrid")
        self.assertEqual(report["method"], "hybrid")
        self.assertLess(hybrid["triangles"], 0.6 * tetra["triangles"])
        for key in ("euler_characteristic", "components", "nonmanifold_edges"):
            self.assertEqual(hybrid[key], tetra[key], key)

    def test_snap(self):
        """Of a smooth field: fewer triangles than marching cubes makes, hardly a sliver, the topology of tetra."""
        volume = self.generate("gyroid", "g.nrrd", "40,40,40", "f32")
        _, tetra = self.surface(volume, "--iso", "127.5")
        _, hybrid = self.surface(volume, "--iso", "127.5", "--method", "hybrid")
        for threshold, most in ((0.4, 0.3), (0.5, 0.25)):
            report, snap = self.surface(volume, "--iso", "127.5", "--method", "snap", "--snap", str(threshold))
            self.assertEqual(report["method"], "snap")
            self.assertLess(snap["triangles"], most * tetra["triangles"])
            self.assertLess(snap["triangles"], 0.75 * hybrid["triangles"])
            self.assertGreater(snap["smallest_angle_median"], 44)
            self.assertLess(snap["angles_below_10"], 0.02)
            self.assertLess(snap["angles_below_10"], 0.2 * tetra["angles_below_10"])
            for key in ("euler_characteristic", "components", "nonmanifold_edges", "nonmanifold_vertices",
                        "misoriented_edges"):
                self.assertEqual(snap[key], tetra[key], key)
        _, usual = self.surface(volume, "--iso", "127.5", "--method", "snap")
        self.assertEqual(usual["hash"], snap["hash"])
        for wrong in ("0.6", "-0.1", "x", "nan", ""):
            self.refuses(2, "extract", volume, "--iso", "1", "--method", "snap", "--snap", wrong, says="--snap")

    def test_closed(self):
        """Surface and complement fill the grid; kernels close as the reference does."""
        volume = self.generate("gyroid", "g.nrrd", "20,21,22", "f32")
        arguments = ["extract", volume, "--iso", "127.5", "--check", "--closed", "--engine"]
        wanted = {}
        for method in ("tetra", "hybrid", "snap"):
            closed = self.report(*arguments, "reference", "--method", method)["surfaces"][0]
            for key in ("boundary_edges", "nonmanifold_edges", "nonmanifold_vertices", "misoriented_edges"):
                self.assertEqual(closed[key], 0, (method, key))
            wanted.setdefault("euler", closed["euler_characteristic"])
            self.assertEqual(closed["euler_characteristic"], wanted["euler"])
            self.assertAlmostEqual(closed["volume"], wanted.setdefault("volume", closed["volume"]), delta=0.05)
        whole = self.report("extract", volume, "--iso", "-1000", "--check", "--closed", "--engine", "reference")
        self.assertAlmostEqual(whole["surfaces"][0]["volume"], 8, places=4)
        if tool_case.HAS_DEVICE:
            told = self.expect(0, *arguments, "opencl", "--verify")
            self.assertIn("closed: 0 boundary edges", told.stdout)
            self.assertIn("same bytes as the reference", told.stdout)

    def test_parity_goes_by_extent(self):
        self.needs_xml()
        points = lattice(self.dims)
        values = list(map(bump, points))
        hashes = {}
        for first in (0, 2, 3):
            name = self.write(f"{first}.vts", vts_text(self.dims, points, [("f", "f32", values)], (), (first, 0, 0)))
            report, surface = self.surface(name, "--iso", "0.5")
            self.assertEqual(report["dims"], [9, 8, 9])
            hashes[first] = surface["hash"]
        self.assertEqual(hashes[0], hashes[2])
        self.assertNotEqual(hashes[0], hashes[3])

    def test_rectilinear(self):
        self.needs_xml()
        axes = [[0.5 * n * n for n in range(self.dims[0])], [float(n) for n in range(self.dims[1])],
                [float(-n) for n in range(self.dims[2])]]
        geometry = "<Coordinates>" + "".join(data_array("xyz"[axis], "f32", axes[axis]) for axis in range(3)) \
            + "</Coordinates>"
        grid = self.write("a.vtr", structured_text("RectilinearGrid", self.dims, (0, 0, 0), geometry,
                                                   [("f", "f32", list(map(bump, lattice(self.dims))))]))
        _, surface = self.surface(grid, "--iso", "0.5")
        _, uniform = self.surface(*self.image(), "--iso", "0.5")
        self.assertEqual(counts(surface), counts(uniform))
        self.assertGreater(surface["volume"], 0)
        self.assertLessEqual(surface["bounds"][1][2], 0)

    def test_blanked(self):
        """A hidden point, a hidden cell and a sample that is no number leave out the same cubes, whatever says so."""
        self.needs_xml()
        points = lattice(self.dims)
        values = list(map(bump, points))
        middle = points.index((6, 4, 4))
        hidden = [2 if n == middle else 0 for n in range(len(points))]
        fields = [("f", "f32", values)]
        blanked = self.write("b.vts", vts_text(self.dims, points, fields + [("vtkGhostType", "u8", hidden)]))
        around = [all(abs(c + 0.5 - m) < 1 for c, m in zip(cell, points[middle]))
                  for cell in lattice([n - 1 for n in self.dims])]
        self.assertEqual(sum(around), 8)
        cells = self.write("c.vts", vts_text(self.dims, points, fields,
                                             [("vtkGhostType", "u8", [32 * hide for hide in around])]))
        missing = self.write("n.vts", vts_text(self.dims, points,
                                               [("f", "f32", [-99.0 if n == middle else value
                                                              for n, value in enumerate(values)])]))
        _, whole = self.surface(*self.image(), "--iso", "0.5")
        _, one = self.surface(blanked, "--iso", "0.5")
        _, two = self.surface(cells, "--iso", "0.5")
        _, three = self.surface(missing, "--iso", "0.5", "--nodata", "-99")
        self.assertEqual(one["hash"], two["hash"])
        self.assertEqual(one["hash"], three["hash"])
        self.assertLess(one["triangles"], whole["triangles"])
        self.assertGreater(one["boundary_edges"], whole["boundary_edges"])
        self.assertRegex(self.expect(0, "extract", blanked, "--iso", "0.5", "--engine", "reference").stderr,
                         "1 point is blanked")
        self.assertRegex(self.expect(0, "extract", cells, "--iso", "0.5", "--engine", "reference").stderr,
                         "8 blanked cells")


if __name__ == "__main__":
    tool_case.main()
