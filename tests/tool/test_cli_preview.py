#!/usr/bin/env python3
"""test_cli_preview.py TOOL [reference] - pictures: PNG that others read, of the right surface and slices, named as meshes

PNG is read by code of this test. What a picture shows follows from the field that was generated. Standard library only.
"""
import json
import math
import os
import struct
import subprocess
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "common"))
import tool_case
from grid_files import HEXAHEDRON, bump, hexahedra, lattice, vtu_text
from png import png_read
from tool_case import GridCase

REFERENCE = ("--engine", "reference")
WHITE = (255, 255, 255)


def seen(rows):
    """(x, y) of the pixels that are not white."""
    return [(x, y) for y, row in enumerate(rows) for x, pixel in enumerate(row) if pixel != WHITE]


class PictureCase(GridCase):
    def needs_png(self):
        if "libpng" in tool_case.tool("info", "none", "--preview", "a.png").stderr:
            self.skipTest("built without libpng")


class Preview(PictureCase):
    def setUp(self):
        super().setUp()
        self.needs_png()

    def picture(self, path):
        with open(path, "rb") as f:
            return png_read(f.read())

    def preview(self, volume, *more, iso="127.5", size="120,90", name="a.png"):
        self.expect(0, "extract", volume, "--iso", iso, *REFERENCE, "--quiet", "--preview", self.path(name),
                    "--preview-size", size, *more)
        return self.picture(self.path(name))

    def test_disc(self):
        """A ball, wherever it is seen from, wherever it lies; of the default size too."""
        volume = self.generate("sphere", "s.nrrd", "40,40,40", "f32")
        pictures = [self.preview(volume, *view) for view in ([], ["--view", "front"], ["--view=-77,3.5"])]
        for width, height, rows in pictures:
            self.assertEqual((width, height), (120, 90))
            radius, found = 0.92 * 45, seen(rows)
            self.assertAlmostEqual(len(found) / (math.pi * radius ** 2), 1, delta=0.06)
            for x, y in found:
                self.assertLess(math.hypot(x + 0.5 - 60, y + 0.5 - 45), radius + 1.5)
                self.assertGreater(rows[y][x][2], rows[y][x][0], "an inner side")
        raw = [self.generate("sphere", "s.raw", "40,40,40", "f32"), "--dims", "40,40,40", "--type", "f32"]
        far = self.path("far.png")
        self.expect(0, "extract", *raw, "--origin", "1e8,-3e7,5e6", "--iso", "127.5", *REFERENCE, "--quiet", "--preview",
                    far, "--preview-size", "120,90")
        differing = sum(a != b for left, right in zip(self.picture(far)[2], pictures[0][2]) for a, b in zip(left, right))
        self.assertLess(differing, 60)
        self.expect(0, "extract", volume, "--iso", "127.5", *REFERENCE, "--quiet", "--preview", far)
        with open(far, "rb") as f:
            self.assertEqual(struct.unpack_from(">II", f.read(), 16), (1024, 768))

    def test_views(self):
        """Three arms from one corner, of different lengths, towards greater x, y and z: an L from every side."""
        size, arms = (10, 14, 20), (6, 10, 16)
        values = [0] * (size[0] * size[1] * size[2])
        for axis, length in enumerate(arms):
            for n in range(length):
                for a in range(4):
                    at = [2 + a % 2, 2 + a // 2]
                    at.insert(axis, 2 + n)
                    values[at[0] + size[0] * (at[1] + size[1] * at[2])] = 9
        volume = self.raw("arms.raw", "u8", size, values)
        x, y, z = arms
        for view, wide, high, corner in (("front", x, z, "left low"), ("back", x, z, "right low"),
                                         ("left", y, z, "right low"), ("right", y, z, "left low"),
                                         ("top", x, y, "left low"), ("bottom", x, y, "left high"),
                                         ("90,0", y, z, "left low"), ("-180,0", x, z, "right low"),
                                         ("90,90", y, x, "left high")):
            _, _, rows = self.preview(volume[0], *volume[1:], f"--view={view}", iso="4.5", size="100,100")
            found = set(seen(rows))
            left, right = min(x for x, _ in found), max(x for x, _ in found)
            top, bottom = min(y for _, y in found), max(y for _, y in found)
            self.assertAlmostEqual((right - left + 1) / (bottom - top + 1), wide / high, delta=0.03, msg=view)
            corners = {"left high": (left + 4, top + 4), "left low": (left + 4, bottom - 4),
                       "right high": (right - 4, top + 4), "right low": (right - 4, bottom - 4)}
            opposite = {"left": "right", "right": "left", "high": "low", "low": "high"}
            far = " ".join(opposite[word] for word in corner.split())
            self.assertIn(corners[corner], found, view)
            self.assertNotIn(corners[far], found, view)

    def test_labels(self):
        """Two boxes side by side, of labels 1 and 2: either half has a colour of its own, also from behind; one name."""
        size = (12, 6, 6)
        values = [(1 if x < 6 else 2) if 1 <= x < 11 and 1 <= y < 5 and 1 <= z < 5 else 0
                  for z in range(6) for y in range(6) for x in range(12)]
        words = ["labels", *self.raw("two.raw", "u8", size, values), *REFERENCE, "--preview-size", "100,50"]
        hues = []
        for view in ("front", "back"):
            self.expect(0, *words, "--smooth", "0", "--preview", self.path("l%%.png"), f"--view={view}")
            rows = self.picture(self.path("l%.png"))[2]
            middles = [rows[25][x] for x in (20, 80)]
            hues.append([[channel - min(pixel) for channel in pixel] for pixel in middles])
            same = sum(rows[y][x] == middles[x > 50] for y in range(20, 30) for x in (*range(12, 44), *range(56, 88)))
            self.assertGreater(same, 500, view)
        self.assertEqual(hues[0], hues[1][::-1])
        self.assertNotEqual(hues[0][0].index(max(hues[0][0])), hues[0][1].index(max(hues[0][1])))
        said = self.expect(0, *words, "--preview", self.path("l.png"), "-o", self.path("l-%.stl"), "--separate", "--json")
        self.assertEqual(json.loads(said.stdout)["preview"], self.path("l.png"))
        self.assertEqual(self.files(), ["l%.png", "l-1.stl", "l-2.stl", "l.png", "two.raw"])
        self.refuses(2, *words, "--preview", self.path("l-%.png"), says="one file has all")
        self.refuses(2, *words, "--preview", self.path("l.jpg"), says=r"let the name end in \.png")
        self.refuses(2, *words, "--preview", "-", "-o", "-", "--format", "ply", says="both name")
        self.refuses(1, *words, "--preview", self.path("no/l.png"), says="create the folder")

    def test_several(self):
        """A picture for each isovalue, and for each block, named as meshes are; with or without -o."""
        volume = self.generate("sphere", "s.nrrd")
        pattern = self.path("s-%.png")
        result = self.expect(0, "extract", volume, "--iso", "100,150", *REFERENCE, "--preview", pattern, "--preview-size",
                             "40,30")
        self.assertRegex(result.stdout, r"preview +\S*s-100\.png\n(.|\n)*preview +\S*s-150\.png\n")
        self.assertEqual(self.files(), ["s-100.png", "s-150.png", "s.nrrd"])
        sizes = [len(seen(self.picture(self.path(name))[2])) for name in ("s-100.png", "s-150.png")]
        self.assertAlmostEqual(sizes[0] / sizes[1], 1, delta=0.1)
        self.refuses(2, "extract", volume, "--iso", "100,150", *REFERENCE, "--preview", self.path("one.png"),
                     says="--preview .*needs a %")

    def test_blocks(self):
        """Of several blocks one picture, or one each; blocks far from each other keep their places."""
        blocks = [((9, 8, 9), lattice((9, 8, 9), (first, 0, 0)), [bump((n, y, z)) for n, y, z in lattice((9, 8, 9))])
                  for first in (0, 40)]
        inputs = self.write_plot3d("b", blocks)
        words = ["extract", *inputs, "--field", "density", "--iso", "3.1", *REFERENCE, "--preview-size", "100,50"]
        self.expect(0, *words, "--preview", self.path("all.png"), "--view", "front")
        _, _, rows = self.picture(self.path("all.png"))
        found = {x for x, _ in seen(rows)}
        self.assertTrue(any(x < 20 for x in found) and any(x > 80 for x in found) and 50 not in found)
        said = self.expect(0, *words, "--preview", self.path("each.png"), "--blocks", "separate").stdout
        self.assertRegex(said, r"preview +\S+each_b0\.png to \S+each_b1\.png")
        [made] = self.report(*words, "--preview", self.path("each.png"), "--blocks", "separate")["surfaces"]
        self.assertEqual(made["previews"], [self.path(f"each_b{n}.png") for n in range(2)])
        self.assertEqual(self.picture(self.path("each_b0.png"))[0], 100)
        self.expect(0, *words, "--preview", self.path("o.png"), "--blocks", "separate", "-o", self.path("o.ply"))
        self.assertEqual([name for name in self.files() if name.startswith("o")],
                         ["o_b0.ply", "o_b0.png", "o_b1.ply", "o_b1.png"])

    def test_blocks_with_own_origins(self):
        """Two, as one cell of each is thin (host/common/far.h); one 16 sizes away from the other."""
        dims, blocks = (9, 8, 9), []
        for first in (0, 144):
            points = [(first + min(x, 7 + x / 128), y, z) for x, y, z in lattice(dims)]
            blocks.append((dims, points, [bump(point) for point in lattice(dims)]))
        inputs = self.write_plot3d("f", blocks)
        words = ["extract", *inputs, "--field", "density", "--iso", "3.1", *REFERENCE, "--preview", self.path("f.png"),
                 "--view", "front", "--preview-size", "300,40", "--json"]
        [surface] = json.loads(self.expect(0, *words).stdout)["surfaces"]
        self.assertIsNone(surface["origin"])
        columns = sorted({x for x, _ in seen(self.picture(self.path("f.png"))[2])})
        gap = max(b - a for a, b in zip(columns, columns[1:]))
        low, high = surface["bounds"]
        self.assertAlmostEqual((columns[-1] - columns[0]) / (gap + (columns[-1] - columns[0] - gap) / 2),
                               (high[0] - low[0]) / 144, delta=0.02)

    def test_stream(self):
        volume = self.generate("sphere", "s.nrrd")
        words = [tool_case.TOOL, "extract", volume, "--iso", "100", *REFERENCE, "--preview", "-", "--preview-size", "40,30"]
        done = subprocess.run(words, stdout=subprocess.PIPE, stderr=subprocess.PIPE, check=True)
        width, height, rows = png_read(done.stdout)
        self.assertEqual((width, height, WHITE in rows[15]), (40, 30, True))
        self.assertIn(b"preview     standard output", done.stderr)
        done = subprocess.run([tool_case.TOOL, "info", volume, "--preview", "-", "--json"], stdout=subprocess.PIPE,
                              stderr=subprocess.PIPE, check=True)
        self.assertEqual(png_read(done.stdout)[:2], (1024, 768))
        self.assertEqual(json.loads(done.stderr)["dims"], [20, 19, 18])

    def test_refused(self):
        volume = self.generate("sphere", "s.nrrd")
        with open(volume, "rb") as f:
            kept = self.write("input.png", f.read())
        extract = ["extract", volume, "--iso", "100", *REFERENCE]
        self.refuses(2, *extract, "--preview", self.path("a.jpg"), says=r"let the name end in \.png")
        self.refuses(2, "extract", kept, "--iso", "100", *REFERENCE, "--preview", kept, says="is the input itself")
        self.refuses(2, "info", kept, "--preview", kept, says="is the input itself")
        same = self.path("x.png")
        self.refuses(2, *extract, "-o", same, "--format", "ply", "--preview", same, says="both name")
        detour = os.path.join(os.path.dirname(same), ".", "x.png")
        self.refuses(2, *extract, "-o", same, "--format", "ply", "--preview", detour, says="both name")
        self.refuses(1, *extract, "-o", self.path("a.ply"), "--preview", self.path("no/a.png"), says="create the folder")
        self.refuses(1, "info", volume, "--preview", self.path("no/a.png"), says="create the folder")
        for view in ("up", "30", "30,91", "nan,0", "400,0", "30,20,10", "", "front,0"):
            self.refuses(2, *extract, "--preview", self.path("a.png"), f"--view={view}", says="--view")
        for size in ("100", "100,", "15,100", "100,8193", "1e2,100", "100,100,3"):
            self.refuses(2, *extract, "--preview", self.path("a.png"), "--preview-size", size, says="--preview-size")
        self.refuses(2, "info", volume, "--view", "front", says="no option --view")
        cells = self.write("cells.vtu", vtu_text(lattice((3, 3, 3)), hexahedra((3, 3, 3)), [HEXAHEDRON] * 8,
                                                 [("f", "f32", [float(n) for n in range(27)])]))
        self.refuses(2, "info", cells, "--preview", self.path("a.png"), says="slices of structured grids")

    def test_empty(self):
        volume = self.generate("empty", "e.nrrd")
        _, _, rows = self.preview(volume)
        self.assertEqual(seen(rows), [])

    def test_mesh_stays(self):
        """What is written, and the report, are as without a picture."""
        volume = self.generate("gyroid", "g.nrrd")
        plain = self.extract([volume], "127.5", "-o", self.path("a.ply"))
        with_one = self.extract([volume], "127.5", "-o", self.path("b.ply"), "--preview", self.path("b.png"))
        self.assertEqual(plain["surfaces"][0]["hash"], with_one["surfaces"][0]["hash"])
        with open(self.path("a.ply"), "rb") as a, open(self.path("b.ply"), "rb") as b:
            self.assertEqual(a.read(), b.read())

    def test_normals_show(self):
        volume = self.generate("gyroid", "g.nrrd", "12,12,12")
        plain, smooth = self.preview(volume), self.preview(volume, "--normals")
        self.assertEqual(set(seen(plain[2])) ^ set(seen(smooth[2])), set())
        self.assertNotEqual(plain, smooth)


class Slices(PictureCase):
    def slices(self, *words):
        path = self.path("i.png")
        result = self.expect(0, "info", *words, "--preview", path, "--preview-size", "240,200")
        with open(path, "rb") as f:
            return png_read(f.read())[2], result

    def setUp(self):
        super().setUp()
        self.needs_png()

    def test_isolines(self):
        """The lines around a ball's three great circles, as long as circles are."""
        volume = self.generate("sphere", "s.nrrd", "33,33,33", "f32")
        rows, result = self.slices(volume, "--iso", "127.5")
        self.assertRegex(result.stdout, r"\npreview +\S+i\.png\n")
        red = [(x, y) for x, y in seen(rows) if rows[y][x] == (214, 39, 40)]
        side = (200 - 3 * 8) / 2
        radius = 2 / 3 / 2 * side  # 255 (1 - 0.75 r) = 127.5
        left, top = (240 - 2 * side - 8) / 2, (200 - 2 * side - 8) / 2
        middles = [(left + side / 2, top + side / 2), (left + side / 2, top + 1.5 * side + 8),
                   (left + 1.5 * side + 8, top + 1.5 * side + 8)]
        for x, y in red:
            self.assertLess(min(abs(math.hypot(x + 0.5 - a, y + 0.5 - b) - radius) for a, b in middles), 2)
        self.assertGreater(len(red), 3 * 2 * math.pi * radius)
        self.assertLess(len(red), 3 * 2 * math.pi * radius * 3)
        without, _ = self.slices(volume)
        self.assertFalse(any(r != g or g != b for row in without for r, g, b in row))

    def test_directions(self):
        """A MetaImage whose axes are -y, z and x: the picture is that of the same volume in x, y, z."""
        nx, ny, nz = 5, 7, 9

        def field(x, y, z):
            return 3 * x + y * y + 2 * z * x

        straight = [field(x, y, z) for z in range(nz) for y in range(ny) for x in range(nx)]
        turned = [field(x, ny - 1 - j, z) for x in range(nx) for z in range(nz) for j in range(ny)]
        self.write("straight.raw", bytes(straight))
        self.write("turned.raw", bytes(turned))
        header = ("ObjectType = Image\nNDims = 3\nDimSize = {}\nTransformMatrix = {}\nElementSpacing = 1 1 1\n"
                  "ElementType = MET_UCHAR\nElementDataFile = {}\n")
        one = self.write("straight.mhd", header.format("5 7 9", "1 0 0 0 1 0 0 0 1", "straight.raw"))
        two = self.write("turned.mhd", header.format("7 9 5", "0 -1 0 0 0 1 1 0 0", "turned.raw"))
        self.assertEqual(self.slices(one)[0], self.slices(two)[0])

    def test_missing_and_parts(self):
        values = [n % 9 for n in range(9 ** 3)]
        volume = self.raw("v.raw", "u8", (9, 9, 9), values)
        yellow = (250, 240, 200)
        rows, _ = self.slices(*volume, "--nodata", "8")
        self.assertGreater(sum(row.count(yellow) for row in rows), 500)
        self.assertEqual(sum(row.count(yellow) for row in self.slices(*volume)[0]), 0)
        part, _ = self.slices(*volume, "--roi", "0:5,0:5,0:5")
        whole = self.slices(*self.raw("w.raw", "u8", (5, 5, 5), [n % 5 for n in range(125)]))[0]
        self.assertEqual(part, whole)


if __name__ == "__main__":
    tool_case.main(device=False)
