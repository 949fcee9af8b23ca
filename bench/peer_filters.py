"""Isosurface filters that peers.py measures beside ours: each wraps the samples of a case; a turn makes one surface.

The samples are those of peers.py: array(), and for grids that are not uniform points() and cells().
"""

import importlib.metadata
import time

from meshlib import mrmeshnumpy, mrmeshpy
from skimage.measure import marching_cubes
from vtkmodules.util.numpy_support import get_vtk_array_type, numpy_to_vtk, numpy_to_vtkIdTypeArray
from vtkmodules.vtkCommonCore import vtkPoints, vtkSMPTools, vtkVersion
from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkImageData, vtkStructuredGrid, vtkUnstructuredGrid
from vtkmodules.vtkFiltersCore import (vtkContour3DLinearGrid, vtkContourFilter, vtkFlyingEdges3D,
                                       vtkMarchingCubes)

UNSTRUCTURED = {"tetrahedra": 10, "hexahedra": 12}  # VTK's types of cells
SECOND_RATIO = 1.05  # tetracubes-bench's own default for its second isovalue


def vtk_start(threads):
    """Gives VTK its threads, 0: all cores. Wheels of VTK have one unless they are told."""
    if vtkSMPTools.GetBackend() == "Sequential":
        vtkSMPTools.SetBackend("STDThread")
    vtkSMPTools.Initialize(threads)
    return {"version": vtkVersion.GetVTKVersion(), "threads": vtkSMPTools.GetEstimatedNumberOfThreads(),
            "backend": vtkSMPTools.GetBackend()}


def versions():
    """Of the others."""
    return {"skimage": importlib.metadata.version("scikit-image"), "meshlib": importlib.metadata.version("meshlib")}


class VtkFilter:
    """An isosurface filter of VTK on a data set that wraps the samples."""

    def __init__(self, kind, samples, iso):
        values = samples.array().reshape(-1)
        scalars = numpy_to_vtk(values, deep=0, array_type=get_vtk_array_type(values.dtype))
        self.keep = values
        self.image = vtkImageData() if samples.grid == "uniform" else vtkStructuredGrid()
        self.image.SetDimensions(samples.dims)
        if samples.grid != "uniform":
            self.coordinates = samples.points()
            points = vtkPoints()
            points.SetData(numpy_to_vtk(self.coordinates, deep=0))
            self.image.SetPoints(points)
        self.image.GetPointData().SetScalars(scalars)
        self.kind, self.iso = kind, iso
        self.triangles = 0

    def turn(self):
        """Milliseconds of Update() of a new filter."""
        surface = self.kind()
        surface.SetInputData(self.image)
        surface.ComputeNormalsOff()
        surface.ComputeGradientsOff()
        surface.ComputeScalarsOff()
        surface.SetValue(0, self.iso)
        begin = time.perf_counter()
        surface.Update()
        ms = 1e3 * (time.perf_counter() - begin)
        self.triangles = surface.GetOutput().GetNumberOfPolys()
        return ms


class VtkLinear:
    """vtkContour3DLinearGrid on an unstructured grid."""

    def __init__(self, samples, iso):
        self.values, self.points, self.cells = samples.array().reshape(-1), samples.points(), samples.cells()
        points, cells, self.mesh = vtkPoints(), vtkCellArray(), vtkUnstructuredGrid()
        points.SetData(numpy_to_vtk(self.points, deep=0))
        cells.SetData(self.cells.shape[1], numpy_to_vtkIdTypeArray(self.cells.reshape(-1), deep=0))
        self.mesh.SetPoints(points)
        self.mesh.SetCells(UNSTRUCTURED[samples.grid], cells)
        self.mesh.GetPointData().SetScalars(numpy_to_vtk(self.values, deep=0))
        self.iso, self.triangles = iso, 0

    def turn(self, second=False):
        """Milliseconds of Update() of a new filter; second: of a second isovalue, the first has built a scalar tree."""
        surface = vtkContour3DLinearGrid()
        surface.SetInputData(self.mesh)
        surface.SetMergePoints(True)
        surface.InterpolateAttributesOff()
        surface.ComputeNormalsOff()
        surface.SetUseScalarTree(second)
        if second:
            surface.SetValue(0, self.iso)
            surface.Update()
        surface.SetValue(0, self.iso * SECOND_RATIO if second else self.iso)
        begin = time.perf_counter()
        surface.Update()
        ms = 1e3 * (time.perf_counter() - begin)
        if not second:
            self.triangles = surface.GetOutput().GetNumberOfPolys()
        return ms


class ScikitImage:
    """skimage.measure.marching_cubes on the samples."""

    def __init__(self, samples, iso):
        self.values, self.iso = samples.array(), iso
        self.triangles = 0

    def turn(self):
        """Milliseconds of one call."""
        begin = time.perf_counter()
        mesh = marching_cubes(self.values, self.iso)
        ms = 1e3 * (time.perf_counter() - begin)
        self.triangles = len(mesh[1])
        return ms


class MeshLib:
    """MeshLib's marchingCubes on the samples, which it wants as floats, by all cores."""

    def __init__(self, samples, iso):
        self.volume = mrmeshnumpy.simpleVolumeFrom3Darray(samples.array().astype("f4"))
        self.parameters = mrmeshpy.MarchingCubesParams()
        self.parameters.iso = iso
        self.triangles = 0

    def turn(self):
        """Milliseconds of one call."""
        begin = time.perf_counter()
        mesh = mrmeshpy.marchingCubes(self.volume, self.parameters)
        ms = 1e3 * (time.perf_counter() - begin)
        self.triangles = mesh.topology.numValidFaces()
        return ms


def filters_of(samples, iso):
    """Those that can do it in seconds, by the key of their results."""
    if samples.grid in UNSTRUCTURED:
        return {"vtk_linear": VtkLinear(samples, iso)}
    if samples.grid == "curvilinear":
        return {"vtk_contour": VtkFilter(vtkContourFilter, samples, iso)}
    peers = {"vtk": VtkFilter(vtkFlyingEdges3D, samples, iso)}
    if samples.count() <= 512 ** 3:
        peers["vtk_mc"] = VtkFilter(vtkMarchingCubes, samples, iso)
    if samples.count() <= 256 ** 3:
        peers.update(skimage=ScikitImage(samples, iso), meshlib=MeshLib(samples, iso))
    return peers
