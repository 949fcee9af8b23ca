#!/usr/bin/env python3
"""test_cli_stacks.py TOOL [reference] - TIFF stacks on the command line: surfaces are those of the same raw samples

Files are made here, and packed by tiffcp (Debian: libtiff-tools) where it is there.
"""
import json
import os
import shutil
import struct
import subprocess
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "common"))
import tool_case
from tool_case import GridCase

DIMS = (23, 19, 7)
KINDS = {"u8": ("B", 1, 1), "u16": ("H", 2, 1), "f32": ("f", 4, 3)}  # struct's letter, bytes, TIFF's format
REFERENCE = ("--engine", "reference")


def values():
    return [(x * x + 3 * y + 5 * z * z) % 251 for z in range(DIMS[2]) for y in range(DIMS[1]) for x in range(DIMS[0])]


def tiff(pages, kind, is_big=False):
    """Pages of one strip each: a classic file, or a BigTIFF."""
    letter, size, sample_format = KINDS[kind]
    link, number, wide = ("<Q", "<Q", 16) if is_big else ("<I", "<H", 4)
    out = bytearray(b"II" + (struct.pack("<HHHQ", 43, 8, 0, 16) if is_big else struct.pack("<HI", 42, 8)))
    for n, page in enumerate(pages):
        tags = {256: (4, DIMS[0]), 257: (4, DIMS[1]), 258: (3, 8 * size), 259: (3, 1), 262: (3, 1), 273: (wide, 0),
                277: (3, 1), 278: (4, DIMS[1]), 279: (wide, size * len(page)), 339: (3, sample_format)}
        data = len(out) + struct.calcsize(number) + len(tags) * (20 if is_big else 12) + struct.calcsize(link)
        tags[273] = (wide, data)
        out += struct.pack(number, len(tags))
        for tag, (width, value) in tags.items():
            out += struct.pack("<HHQQ" if is_big else "<HHII", tag, width, 1, value)
        out += struct.pack(link, data + size * len(page) if n + 1 < len(pages) else 0)
        out += struct.pack(f"<{len(page)}{letter}", *page)
    return bytes(out)


class Stacks(GridCase):
    def setUp(self):
        super().setUp()
        if "TIFF" not in self.expect(0, "--version").stdout:
            self.skipTest("built without libtiff")
        plane = DIMS[0] * DIMS[1]
        self.pages = [values()[n * plane:(n + 1) * plane] for n in range(DIMS[2])]

    def surface(self, *words):
        done = self.expect(0, "extract", *words, "--iso", "99.5", "--json", *REFERENCE)
        return json.loads(done.stdout)["surfaces"][0]["hash"]

    def test_files(self):
        for kind in KINDS:
            wanted = self.surface(*self.raw("a.raw", kind, DIMS, values()))
            for is_big in (False, True):
                path = self.write("a.tif", tiff(self.pages, kind, is_big))
                self.assertEqual(self.surface(path), wanted)
                with open(path, "rb") as file:
                    done = subprocess.run([tool_case.TOOL, "extract", "-", "--iso", "99.5", "--json", *REFERENCE],
                                          stdin=file, stdout=subprocess.PIPE, timeout=400)
                self.assertEqual(json.loads(done.stdout)["surfaces"][0]["hash"], wanted)
                if not shutil.which("tiffcp"):
                    continue
                for how in (["-c", "lzw"], ["-c", "lzw:2"], ["-c", "zip"], ["-c", "packbits"], ["-c", "zstd"],
                            ["-c", "lzma"], ["-c", "lzw", "-t", "-w", "16", "-l", "32"], ["-B", "-r", "3"]):
                    if kind == "f32" and how == ["-c", "lzw:2"]:
                        how = ["-c", "zip:3"]  # the predictor of numbers of floating point
                    packed = self.path("packed.tif")
                    done = subprocess.run(["tiffcp", *how, path, packed], stderr=subprocess.PIPE, timeout=400)
                    if done.returncode == 0 and b"not configured" not in done.stderr:
                        self.assertEqual(self.surface(packed), wanted, (kind, is_big, how))

    def test_slices(self):
        wanted = self.surface(*self.raw("a.raw", "u16", DIMS, values()))
        os.mkdir(self.path("slices"))
        for n, page in enumerate(self.pages):
            self.write(f"slices/{n + 98}.tif", tiff([page], "u16"))
        for name in ("slices", "slices/", "slices/%d.tif", "slices/%02d.tif"):
            self.assertEqual(self.surface(self.path(name)), wanted, name)
        part = self.surface(self.path("slices"), "--roi", "2:20,:,1:6", "--step", "1,2,1")
        self.assertEqual(part, self.surface(*self.raw("a.raw", "u16", DIMS, values()), "--roi", "2:20,:,1:6", "--step",
                                            "1,2,1"))
        self.refuses(2, "extract", self.path("slices"), "--iso", "99.5", *REFERENCE, "-o",
                     self.path("slices/99.tif"), "--format", "ply", says="read as part of it")
        self.refuses(2, "info", self.path("slices/%d.raw"), "--dims", "4,4,4", "--type", "u8", says="by a line as 'data file: ")
        self.write("slices/7.raw", b"no TIFF")
        self.refuses(4, "info", self.path("slices/%d.raw"), says="7.raw: is no TIFF, by its first bytes; slices of raw")
        self.refuses(2, "info", *[self.path(f"slices/{n}.tif") for n in (98, 99, 100)],
                     says=r"100\.tif' is a third. Slices of TIFF are one input: their folder, or")
        os.remove(self.path("slices/100.tif"))
        self.refuses(4, "info", self.path("slices/%d.tif"), says="slices 99 and 101")

    def test_mask(self):
        self.write("mask.tif", tiff([[1] * len(page) for page in self.pages], "u8"))
        raw = self.raw("a.raw", "u16", DIMS, values())
        self.assertEqual(self.surface(*raw, "--mask", self.path("mask.tif")), self.surface(*raw))


if __name__ == "__main__":
    tool_case.main()
