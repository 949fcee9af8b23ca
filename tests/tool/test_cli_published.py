#!/usr/bin/env python3
"""test_cli_published.py TOOL [reference] - the command line on published files

Every file in the folder TETRACUBES_DATA that is read opens with info, and published counts and ranges hold. All of it
is skipped where the variable is unset.
"""
import os
import sys
import unittest

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "common"))
import tool_case
from tool_case import GridCase

DATA = os.environ.get("TETRACUBES_DATA")


@unittest.skipUnless(DATA, "TETRACUBES_DATA is unset; it names the folder of published data")
class Published(GridCase):
    REFUSED = {"unstructured/disk_out_ref.ex2": "Exodus"}
    PAIRS = {"bluntfinxyz.bin": "bluntfinq.bin", "combxyz.bin": "combq.bin", "postxyz.bin": "postq.bin",
             "multi-ascii.xyz": "multi-ascii.q", "multi-bin.xyz": "multi-bin.q", "multi-bin-C.xyz": "multi-bin-C.q",
             "tiny.xyz": "tiny.q"}
    # file or grid, field, dims, range of the field; digits as the data's description gives them
    FACTS = [("uniform/ironProt.vtk", "scalars", [68, 68, 68], [0, 255]),
             ("uniform/vase.vti", "SLCImage", [115, 101, 75], [0, 239]),
             ("uniform/hydrogen.vti", None, [64, 64, 64], [0, 1]),
             ("uniform/heart.vti", None, [32, 32, 12], [0, 255]),
             ("uniform/heart.vtk", None, [32, 32, 12], [0, 255]),
             ("curvilinear/bluntfinxyz.bin", "density", [40, 32, 32], [0.1926, 4.9775]),
             ("curvilinear/combxyz.bin", "density", [57, 33, 25], [0.198, 0.710]),
             ("curvilinear/postxyz.bin", "energy", [38, 76, 38], [-0.54, 4.40]),
             ("curvilinear/SampleStructGrid.vtk", "scalars", [20, 30, 40], [0, 1.305]),
             ("unstructured/CylinderLinear.vtk", "vel_norm", None, [0, 1.004]),
             ("unstructured/hexa.vtk", None, None, [0.75, 17.3]),
             ("unstructured/fire_ug.vtu", "t", None, [298, 692]),
             ("unstructured/notch_stress_fixed.vtk", None, None, [3.2e3, 8.1e6])]
    CLOSED = [("unstructured/hexa.vtk", 5.0)]
    BORDERED = [("unstructured/fire_ug.vtu", "t", 400), ("unstructured/fichera-mixed.vtu", "f", 0.5),
                ("unstructured/fichera-mixed-16.vtu", "f", 0.5)]

    def inputs(self, path):
        whole = os.path.join(DATA, path)
        second = self.PAIRS.get(os.path.basename(path))
        return [whole] + ([os.path.join(os.path.dirname(whole), second)] if second else [])

    def lacks(self, path):
        formats = self.expect(0, "--version").stdout
        return (path.endswith((".vti", ".vtr", ".vts", ".vtu")) and "VTK XML" not in formats
                or ".nii" in path and "NIfTI" not in formats)

    def test_everything_readable_opens(self):
        readable = (".vtk", ".vti", ".vtr", ".vts", ".vtu", ".nrrd", ".nhdr", ".mhd", ".nii", ".nii.gz")
        opened = 0
        for kind in ("uniform", "curvilinear", "unstructured"):
            for name in sorted(os.listdir(os.path.join(DATA, kind))):
                if not name.endswith(readable) and name not in self.PAIRS or self.lacks(name):
                    continue
                with self.subTest(file=name):
                    info = self.report("info", *self.inputs(f"{kind}/{name}"))
                    self.assertGreaterEqual(len(info["blocks"]), 1)
                    opened += 1
        self.assertGreater(opened, 20)
        for name, says in self.REFUSED.items():
            self.refuses(4, "info", os.path.join(DATA, name), says=says)

    def test_facts(self):
        for path, name, dims, wanted in self.FACTS:
            with self.subTest(file=path):
                if self.lacks(path):
                    continue
                blocks = self.report("info", *self.inputs(path))["blocks"]
                self.assertEqual([block["dims"] for block in blocks], [dims])
                scalars = [field for field in blocks[0]["fields"] if field["name"] == name or not name]
                near = [field["ranges"][0] for field in scalars if field["components"] == 1 and all(
                    abs(got - end) <= 0.006 * max(abs(end), abs(wanted[1]))
                    for got, end in zip(field["ranges"][0], wanted))]
                self.assertTrue(near, f"{wanted} is none of {scalars}")

    def test_surfaces_of_unstructured_grids(self):
        for path, iso in self.CLOSED:
            with self.subTest(file=path):
                _, surface = self.surface(os.path.join(DATA, path), "--iso", iso, *self.only_scalar(path))
                self.assertEqual((surface["boundary_edges"], surface["nonmanifold_vertices"]), (0, 0))
                self.assertGreater(surface["triangles"], 0)
        for path, field, iso in self.BORDERED:
            with self.subTest(file=path):
                if self.lacks(path):
                    continue
                _, surface = self.surface(os.path.join(DATA, path), "--iso", iso, "--field", field)
                self.assertGreater(surface["triangles"], 0)

    def only_scalar(self, path):
        fields = self.report("info", os.path.join(DATA, path))["blocks"][0]["fields"]
        scalars = [field["name"] for field in fields if field["components"] == 1]
        return ["--field", scalars[0]] if len(fields) > 1 else []

    def test_pieces_hold_the_points_of_the_whole(self):
        """The combustor in three pieces against the same in one: cubes, and the surface but for what pieces share."""
        if self.lacks(".vts"):
            self.skipTest("built without VTK XML")
        pieces = [self.report("info", os.path.join(DATA, f"curvilinear/multicomb_{n}.vts"))["blocks"][0]
                  for n in range(3)]
        whole = self.report("info", *self.inputs("curvilinear/combxyz.bin"))["blocks"][0]
        for piece in pieces:
            for axis in range(3):
                self.assertGreaterEqual(piece["bounds"][0][axis], whole["bounds"][0][axis] - 1e-4)
                self.assertLessEqual(piece["bounds"][1][axis], whole["bounds"][1][axis] + 1e-4)
        for n in range(3):
            _, surface = self.surface(os.path.join(DATA, f"curvilinear/multicomb_{n}.vts"), "--field", "Density",
                                      "--iso", 0.37)
            self.assertGreater(surface["triangles"], 0)

    def test_nothing_to_contour(self):
        blow = os.path.join(DATA, "unstructured/blow.vtk")
        fields = self.report("info", blow)["blocks"][0]["fields"]
        scalars = [field["name"] for field in fields if field["components"] == 1]
        if scalars:
            result = self.expect(0, "extract", blow, "--field", scalars[0], "--iso", "0.5", "--engine", "reference")
            self.assertRegex(result.stderr, "nothing to contour")

    def test_quadratic_cells_are_linearised(self):
        for name in ("QuadraticTetra.vtu", "QuadraticPyramid.vtu", "QuadraticWedge.vtu"):
            with self.subTest(file=name):
                if self.lacks(name):
                    continue
                result = self.expect(0, "extract", os.path.join(DATA, "unstructured", name), "--field",
                                     "DistanceToCenter", "--iso", "0.8", "--engine", "reference", "--check")
                self.assertRegex(result.stderr, "taken as linear")


if __name__ == "__main__":
    tool_case.main()
