#!/usr/bin/env python3
"""test_cli_hdf5.py TOOL [reference] - datasets that h5py (Debian: python3-h5py) has written: surfaces of the same arrays"""
import gzip
import itertools
import json
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "common"))
import tool_case
from tool_case import GridCase

try:
    import h5py
    import numpy
except ImportError:
    h5py = numpy = None
REFERENCE = ("--engine", "reference")


@tool_case.unittest.skipUnless(h5py, "Python has no h5py (Debian: python3-h5py)")
class Datasets(GridCase):
    def setUp(self):
        super().setUp()
        if "HDF5" not in self.expect(0, "--version").stdout:
            self.skipTest("built without libhdf5")
        z, y, x = numpy.indices((7, 8, 9))
        self.array = ((x * x + 3 * y + 2 * z * z) % 101).astype("u1")
        numpy.save(self.path("a.npy"), self.array)
        self.wanted = self.surface("a.npy")["hash"]

    def surface(self, name, *more):
        return json.loads(self.expect(0, "extract", self.path(name), "--json", *REFERENCE,
                                      *(() if "--iso" in more else ("--iso", "50.5")), *more).stdout)["surfaces"][0]

    def test_forms(self):
        chunked = dict(chunks=(2, 3, 4))
        forms = ({}, chunked, dict(chunked, compression="gzip"), dict(chunked, compression="gzip", shuffle=True),
                 dict(chunked, compression="lzf"), dict(chunked, fletcher32=True), dict(chunked, maxshape=(None,) * 3))
        kinds = ("u1", "<i2", ">u4", "<f4", ">f8", "<i8")
        for library, form, kind in itertools.product(("earliest", "latest"), forms, kinds):
            with h5py.File(self.path("a.h5"), "w", libver=library) as file:
                file.create_dataset("group/volume", data=self.array.astype(kind), **form)
            if form.get("compression") == "lzf":  # a filter of h5py's own
                self.refuses(4, "info", self.path("a.h5"), says="filter")
                continue
            self.assertEqual(self.surface("a.h5")["hash"], self.wanted, (library, form, kind))
            self.assertEqual(self.surface("a.h5:/group/volume")["hash"], self.wanted)

    def test_booleans_and_enumerations(self):
        """h5py's booleans are an enumeration over int8: u8 of 0 and 1; others are the numbers that they name. PyTables has
        booleans as 8 bits."""
        mask = self.array > 50
        numpy.save(self.path("m.npy"), mask.astype("u1"))
        wanted = self.surface("m.npy", "--iso", "0.5")["hash"]
        for form in ({}, dict(chunks=(2, 3, 4), compression="gzip", shuffle=True), dict(chunks=(2, 3, 4))):
            with h5py.File(self.path("m.h5"), "w") as file:
                file.create_dataset("mask", data=mask, **form)
            facts = json.loads(self.expect(0, "info", self.path("m.h5"), "--json").stdout)
            self.assertEqual((facts["type"], facts["range"]), ("u8", [0, 1]))
            self.assertEqual(self.surface("m.h5", "--iso", "0.5")["hash"], wanted)
        masked = [self.surface("a.npy", "--mask", self.path(name))["hash"] for name in ("m.h5", "m.npy")]
        self.assertEqual(*masked)
        labels = json.loads(self.expect(0, "labels", self.path("m.h5"), "--json", *REFERENCE).stdout)["labels"]
        self.assertEqual([row["label"] for row in labels], [1])
        named = h5py.enum_dtype({"AIR": 0, "BONE": 1, "SKIN": 40, "OTHER": 77}, basetype=">i2")
        with h5py.File(self.path("e.h5"), "w") as file:
            file.create_dataset("organs", data=self.array.astype(">i2"), dtype=named)
        self.assertEqual(self.surface("e.h5")["hash"], self.wanted)
        self.assertEqual(json.loads(self.expect(0, "info", self.path("e.h5"), "--json").stdout)["type"], "i16")
        with h5py.File(self.path("b.h5"), "w") as file:
            bits = h5py.h5d.create(file.id, b"bits", h5py.h5t.STD_B8LE, h5py.h5s.create_simple(mask.shape))
            bits.write(h5py.h5s.ALL, h5py.h5s.ALL, mask.astype("u1"), h5py.h5t.STD_B8LE)
        self.assertEqual(self.surface("b.h5", "--iso", "0.5")["hash"], wanted)

    def test_chunks_that_were_not_written(self):
        for fill in (0, 77):
            array = self.array.astype(">i2")
            array[4:] = fill
            array[:, :, 4:] = fill
            with h5py.File(self.path("a.h5"), "w") as file:
                made = file.create_dataset("v", shape=array.shape, dtype=">i2", chunks=(4, 8, 4), fillvalue=fill,
                                           compression="gzip")
                made[:4, :, :4] = array[:4, :, :4]
            numpy.save(self.path("b.npy"), array)
            self.assertEqual(self.surface("a.h5")["hash"], self.surface("b.npy")["hash"])

    def test_image_of_vtk(self):
        """VTKHDF: a group with the place of an image, and its fields."""
        with h5py.File(self.path("a.vtkhdf"), "w") as file:
            group = file.create_group("VTKHDF")
            group.attrs["Version"] = (1, 0)
            group.attrs["Type"] = numpy.bytes_("ImageData")
            group.attrs["WholeExtent"] = (2, 10, 0, 7, 1, 7)
            group.attrs["Spacing"], group.attrs["Origin"] = (0.5, 2.0, 3.0), (10.0, 20.0, 30.0)
            group.attrs["Direction"] = (0.0, 1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0)
            group.create_dataset("PointData/bump", data=self.array)
            group.create_dataset("CellData/c", data=self.array[1:, 1:, 1:])
        name = "a.vtkhdf:/VTKHDF/PointData/bump"
        facts = json.loads(self.expect(0, "info", self.path(name), "--json").stdout)
        self.assertEqual(facts["matrix"], [[0, 2, 0, 10], [0.5, 0, 0, 21], [0, 0, 3, 33]])
        self.refuses(4, "info", self.path("a.vtkhdf:/VTKHDF/CellData/c"), says="values of cells")

    def test_parts_and_places(self):
        with h5py.File(self.path("a.h5"), "w", userblock_size=512) as file:
            file["a"] = self.array
            file["b"] = numpy.stack([self.array * 0, self.array, self.array * 2])
            file["c"] = numpy.stack([self.array, self.array * 0], -1)
            file["a"].attrs["element_size_um"] = [3.0, 2.0, 0.5]
        self.refuses(2, "info", self.path("a.h5"), says=r"holds 3 datasets: .* /a, /b, /c")
        self.assertEqual(self.surface("a.h5:/b", "--frame", "1")["hash"], self.wanted)
        self.assertEqual(self.surface("a.h5:/c", "--component", "0")["hash"], self.wanted)
        self.assertEqual(self.surface("a.h5:/a", "--spacing", "1,1,1")["hash"], self.wanted)
        part = ("--roi", "2:8,1:,:6", "--step", "1,1,2")
        self.assertEqual(self.surface("a.h5:/a", "--spacing", "1,1,1", *part)["hash"],
                         self.surface("a.npy", *part)["hash"])
        facts = json.loads(self.expect(0, "info", self.path("a.h5:/a"), "--json").stdout)
        self.assertEqual((facts["format"], facts["spacing"]), ("HDF5", [0.5, 2, 3]))
        self.refuses(2, "extract", self.path("a.h5:/a"), "--iso", "1", *REFERENCE, "-o", self.path("a.h5"), "--format",
                     "ply", says="read as part of it")

    def test_streams(self):
        """On standard input, and packed as a whole: libhdf5 reads memory."""
        for form in ({}, dict(chunks=(2, 3, 4), compression="gzip")):
            with h5py.File(self.path("a.h5"), "w") as file:
                file.create_dataset("a", data=self.array, **form)
                file.create_dataset("b", data=self.array * 0, **form)
            with open(self.path("a.h5"), "rb") as file, gzip.open(self.path("a.h5.gz"), "wb") as packed:
                packed.write(file.read())
            self.assertEqual(self.surface("a.h5.gz:/a")["hash"], self.wanted)
            for name in ("a.h5", "a.h5.gz"):
                with open(self.path(name), "rb") as file:
                    done = tool_case.subprocess.run(
                        [tool_case.TOOL, "extract", "/dev/stdin:/a", "--iso", "50.5", "--json", *REFERENCE], stdin=file, stdout=-1,
                        stderr=-1, timeout=60)
                self.assertEqual((done.returncode, done.stderr), (0, b""))
                self.assertEqual(json.loads(done.stdout)["surfaces"][0]["hash"], self.wanted)


if __name__ == "__main__":
    tool_case.main()
