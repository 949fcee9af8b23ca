#!/usr/bin/env python3
"""test_pieces_vtk.py TOOL [reference] - parallel files that VTK itself writes give the surface of the grid they were made of;
skipped where this Python has no VTK"""
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "common"))
import tool_case
from tool_case import GridCase, counts

try:
    import vtk
    from vtk.util.numpy_support import vtk_to_numpy
except ImportError:
    print("skipped: this Python has no VTK")
    sys.exit(77)

FIELD = "RTData"
kept = []  # sources, which pipelines do not keep


def source():
    wave = vtk.vtkRTAnalyticSource()
    wave.SetWholeExtent(-6, 7, -5, 6, 0, 9)
    kept.append(wave)
    return wave


def curvilinear():
    to = vtk.vtkImageDataToPointSet()
    to.SetInputConnection(source().GetOutputPort())
    return to


def hexahedra():
    """Of the image, piece by piece."""
    to = vtk.vtkAppendFilter()
    to.SetInputConnection(source().GetOutputPort())
    return to


def write(writer, data, path, encoding, pieces=None, ghosts=0):
    writer.SetInputConnection(data.GetOutputPort())
    writer.SetFileName(path)
    if encoding == "ascii":
        writer.SetDataModeToAscii()
    elif encoding == "raw":
        writer.SetDataModeToAppended()
        writer.EncodeAppendedDataOff()
        writer.SetCompressorTypeToNone()
    if pieces:
        writer.SetNumberOfPieces(pieces)
        writer.SetStartPiece(0)
        writer.SetEndPiece(pieces - 1)
        writer.SetGhostLevel(ghosts)
    assert writer.Write(), path
    return path


class WrittenByVtk(GridCase):
    def test_images_and_structured_grids(self):
        for name, data, ending, one, many in (
                ("image", source, "vti", vtk.vtkXMLImageDataWriter, vtk.vtkXMLPImageDataWriter),
                ("structured", curvilinear, "vts", vtk.vtkXMLStructuredGridWriter, vtk.vtkXMLPStructuredGridWriter)):
            for encoding in ("ascii", "raw", "packed"):
                whole = write(one(), data(), self.path(f"whole.{ending}"), encoding)
                for pieces in (1, 3, 8):
                    for ghosts in (0, 1, 2):
                        with self.subTest(name=name, encoding=encoding, pieces=pieces, ghosts=ghosts):
                            parts = write(many(), data(), self.path(f"{name}{pieces}{ghosts}.p{ending}"), encoding,
                                          pieces, ghosts)
                            _, first = self.surface(whole, "--field", FIELD, "--iso", "150.5")
                            _, second = self.surface(parts, "--field", FIELD, "--iso", "150.5")
                            self.assertGreater(first["triangles"], 100)
                            self.assertEqual(first["hash"], second["hash"])

    def test_unstructured_grids(self):
        """Without global numbers hexahedra are cut in another way; the surface has the same pieces and no seam."""
        whole = write(vtk.vtkXMLUnstructuredGridWriter(), hexahedra(), self.path("whole.vtu"), "raw")
        same = ("euler_characteristic", "components", "boundary_edges", "nonmanifold_edges")
        _, first = self.surface(whole, "--field", FIELD, "--iso", "150.5")
        for pieces in (1, 3, 8):
            for ghosts in (0, 1):
                with self.subTest(pieces=pieces, ghosts=ghosts):
                    parts = write(vtk.vtkXMLPUnstructuredGridWriter(), hexahedra(), self.path(f"{pieces}{ghosts}.pvtu"),
                                  "raw", pieces, ghosts)
                    report, second = self.surface(parts, "--field", FIELD, "--iso", "150.5")
                    self.assertEqual([first[k] for k in same], [second[k] for k in same])
                    self.assertEqual(report["cells"], 13 * 11 * 9)

    def needs_hdf5(self):
        """As the tool of the wheel has not."""
        if "VTKHDF" not in self.expect(0, "--version").stdout.split("writes:")[1]:
            self.skipTest("built without libhdf5")

    def test_vtkhdf(self):
        """An unstructured grid in one part and in three, polyhedra, as vtkHDFWriter has them."""
        self.needs_hdf5()
        whole = write(vtk.vtkXMLUnstructuredGridWriter(), hexahedra(), self.path("whole.vtu"), "raw")
        _, first = self.surface(whole, "--field", FIELD, "--iso", "150.5")
        for kind in ("whole", "parts", "polyhedra"):
            grid = hexahedra()
            grid.Update()
            data = grid.GetOutput()
            if kind == "polyhedra":  # of tetrahedra: VTK gives polyhedra of voxels faces that cross themselves
                cut = vtk.vtkDataSetTriangleFilter()
                cut.SetInputData(data)
                to = vtk.vtkConvertToPolyhedra()
                to.SetInputConnection(cut.GetOutputPort())
                to.Update()
                data = to.GetOutput()
            if kind == "parts":
                data = vtk.vtkPartitionedDataSet()
                for n, (low, high) in enumerate(((-6, -2), (-2, 3), (3, 7))):
                    cut = vtk.vtkExtractVOI()
                    cut.SetInputConnection(kept[-1].GetOutputPort())
                    cut.SetVOI(low, high, -5, 6, 0, 9)
                    part = vtk.vtkAppendFilter()
                    part.SetInputConnection(cut.GetOutputPort())
                    part.Update()
                    data.SetPartition(n, part.GetOutput())
            writer = vtk.vtkHDFWriter()
            writer.SetInputDataObject(data)
            writer.SetFileName(self.path(kind + ".vtkhdf"))
            self.assertTrue(writer.Write())
            _, second = self.surface(self.path(kind + ".vtkhdf"), "--field", FIELD, "--iso", "150.5")
            if kind == "whole":
                self.assertEqual(first["hash"], second["hash"])
            same = ("euler_characteristic", "components", "nonmanifold_edges", "misoriented_edges")
            self.assertEqual([first[k] for k in same], [second[k] for k in same])

    def test_vtkhdf_surface(self):
        """VTK reads the VTKHDF file that is written as it reads the VTP file: points, triangles, values by their roles."""
        self.needs_hdf5()
        volume = self.generate("gyroid", "g.nrrd", "24,22,20")
        for iso, more in (("127.5", ["--normals"]), ("127.5", ["--soup"]), ("300", [])):
            meshes = []
            for reader, ending in ((vtk.vtkHDFReader(), "vtkhdf"), (vtk.vtkXMLPolyDataReader(), "vtp")):
                path = self.path("out." + ending)
                self.expect(0, "extract", volume, "--iso", iso, "--engine", "reference", "--quiet", "-o", path, *more)
                reader.SetFileName(path)
                reader.Update()
                meshes.append(reader.GetOutput())
            for arrays in zip(*([vtk_to_numpy(array).tolist() for array in
                                 (mesh.GetPolys().GetConnectivityArray(), mesh.GetPolys().GetOffsetsArray(),
                                  *([mesh.GetPoints().GetData()] if mesh.GetNumberOfPoints() else []),
                                  *([mesh.GetPointData().GetNormals()] if "--normals" in more else []))]
                                for mesh in meshes)):
                self.assertEqual(*arrays)
            self.assertEqual(*(mesh.GetNumberOfPolys() for mesh in meshes))
            self.assertEqual(meshes[0].GetNumberOfCells(), meshes[0].GetNumberOfPolys())

    def test_notes(self):
        """The space of the input, where 3D Slicer looks for it: an array of strings among the field data."""
        self.needs_hdf5()
        self.write("a.nrrd", b"NRRD0005\ntype: uchar\ndimension: 3\nsizes: 4 4 4\nencoding: raw\nspace: LPS\n"
                   b'space directions: (1,0,0) (0,1,0) (0,0,1)\nspace units: "mm" "mm" "mm"\n\n' +
                   bytes(n * 37 % 251 for n in range(64)))
        for reader, ending in ((vtk.vtkHDFReader(), "vtkhdf"), (vtk.vtkXMLPolyDataReader(), "vtp")):
            path = self.path("out." + ending)
            self.expect(0, "extract", self.path("a.nrrd"), "--iso", "127.5", "--engine", "reference", "--quiet", "-o", path)
            reader.SetFileName(path)
            reader.Update()
            fields = reader.GetOutput().GetFieldData()
            self.assertEqual([fields.GetAbstractArray(name).GetValue(0) for name in ("SPACE", "UNITS")], ["LPS", "mm"])

    def test_blocks(self):
        blocks = vtk.vtkMultiBlockDataSet()
        image = source()
        image.Update()
        sphere = vtk.vtkSphereSource()
        sphere.Update()
        blocks.SetBlock(0, image.GetOutput())
        blocks.SetBlock(1, None)
        blocks.SetBlock(2, sphere.GetOutput())
        writer = vtk.vtkXMLMultiBlockDataWriter()
        writer.SetInputDataObject(blocks)
        writer.SetFileName(self.path("a.vtm"))
        self.assertTrue(writer.Write())
        whole = write(vtk.vtkXMLImageDataWriter(), source(), self.path("whole.vti"), "raw")
        _, first = self.surface(whole, "--iso", "150.5")
        _, second = self.surface(self.path("a.vtm"), "--iso", "150.5")
        self.assertEqual(first["hash"], second["hash"])
        self.assertEqual(counts(first), counts(second))


if __name__ == "__main__":
    tool_case.main()
