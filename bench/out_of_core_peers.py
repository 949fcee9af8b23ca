"""One surface of a raw u8 cube, file to file, by another program and in pieces where it can: a process of out_of_core.py

    out_of_core_peers.py WAY VOLUME SIDE ISO OUT PIECES

prints {"ms", "cpu_ms", "vertices", "triangles"} as JSON. Times are from the first object made to the file closed, without
the start of Python and the loading of modules; one rank of several tells no processor time. Vertices at seams count twice,
as they are there twice.

  vtk_memory  vtkImageReader2, vtkFlyingEdges3D, vtkXMLPolyDataWriter on the whole
  vtk_pieces  the same pipeline streamed: the writer asks for PIECES pieces one by one, the reader reads each one's extent
  vtk_slabs   a loop over PIECES slabs: the reader updates an extent, the filter contours it; vtkAppendPolyData, one write
  skimage     marching_cubes on slabs of a numpy.memmap; vertices and faces are appended to two raw files
  paraview    by pvbatch, as many ranks as mpirun starts: ImageReader, Contour, one file of each rank and a .pvtp of them
"""
import json
import sys
import time

WAY, VOLUME, SIDE, ISO, OUT, PIECES = (*sys.argv[1:3], int(sys.argv[3]), float(sys.argv[4]), sys.argv[5],
                                       int(sys.argv[6]))
SLABS = [(n * (SIDE - 1) // PIECES, (n + 1) * (SIDE - 1) // PIECES) for n in range(PIECES)]  # planes, both included


def vtk_reader(vtk):
    reader = vtk.vtkImageReader2()
    reader.SetFileName(VOLUME)
    reader.SetFileDimensionality(3)
    reader.SetDataScalarTypeToUnsignedChar()
    reader.SetDataExtent(0, SIDE - 1, 0, SIDE - 1, 0, SIDE - 1)
    reader.FileLowerLeftOn()
    return reader


def vtk_filter(vtk):
    surface = vtk.vtkFlyingEdges3D()
    surface.ComputeNormalsOff()
    surface.ComputeGradientsOff()
    surface.ComputeScalarsOff()
    surface.SetValue(0, ISO)
    return surface


def vtk_write(vtk, source, pieces):
    writer = vtk.vtkXMLPolyDataWriter()
    writer.SetInputConnection(source.GetOutputPort())
    writer.SetNumberOfPieces(pieces)
    writer.SetDataModeToAppended()
    writer.EncodeAppendedDataOff()
    writer.SetCompressorTypeToNone()
    writer.SetHeaderTypeToUInt64()
    writer.SetFileName(OUT)
    if not writer.Write():
        sys.exit(f"{OUT}: not written")


def vtk_streamed(vtk, pieces):
    """A pipeline; the writer drives it."""
    counts = [0, 0]
    reader, surface = vtk_reader(vtk), vtk_filter(vtk)
    surface.SetInputConnection(reader.GetOutputPort())

    def count(*_):
        counts[0] += surface.GetOutput().GetNumberOfPoints()
        counts[1] += surface.GetOutput().GetNumberOfPolys()

    surface.AddObserver("EndEvent", count)
    vtk_write(vtk, surface, pieces)
    return counts


def vtk_slabs(vtk):
    reader, append = vtk_reader(vtk), vtk.vtkAppendPolyData()
    for first, last in SLABS:
        reader.UpdateExtent((0, SIDE - 1, 0, SIDE - 1, first, last))
        surface, part = vtk_filter(vtk), reader.GetOutput().NewInstance()
        part.ShallowCopy(reader.GetOutput())
        surface.SetInputData(part)
        surface.Update()
        append.AddInputData(surface.GetOutput())
    append.Update()
    vtk_write(vtk, append, 1)
    return append.GetOutput().GetNumberOfPoints(), append.GetOutput().GetNumberOfPolys()


def vtk_modules():
    """What is used of VTK, on all cores: its wheels have one thread unless they are told."""
    from types import SimpleNamespace
    from vtkmodules.vtkCommonCore import vtkSMPTools
    from vtkmodules.vtkFiltersCore import vtkAppendPolyData, vtkFlyingEdges3D
    from vtkmodules.vtkIOImage import vtkImageReader2
    from vtkmodules.vtkIOXML import vtkXMLPolyDataWriter
    if vtkSMPTools.GetBackend() == "Sequential":
        vtkSMPTools.SetBackend("STDThread")
    vtkSMPTools.Initialize(0)
    return SimpleNamespace(**{kind.__name__: kind for kind in (vtkAppendPolyData, vtkFlyingEdges3D, vtkImageReader2,
                                                               vtkXMLPolyDataWriter)})


def skimage_slabs(numpy, marching_cubes):
    volume = numpy.memmap(VOLUME, dtype="u1", mode="r", shape=(SIDE,) * 3)
    vertex_count = triangle_count = 0
    with open(OUT + ".vertices", "wb") as vertices, open(OUT + ".faces", "wb") as faces:
        for first, last in SLABS:
            slab = volume[first:last + 1]
            if not slab.min() < ISO <= slab.max():
                continue
            points, corners = marching_cubes(slab, ISO)[:2]
            points[:, 0] += first
            points.tofile(vertices)
            (corners + vertex_count).tofile(faces)
            vertex_count += len(points)
            triangle_count += len(corners)
    return vertex_count, triangle_count


def paraview(simple):
    reader = simple.ImageReader(FileNames=[VOLUME])
    reader.FileDimensionality = "3"
    reader.DataScalarType = "unsigned char"
    reader.DataByteOrder = "LittleEndian"
    reader.DataExtent = [0, SIDE - 1] * 3
    surface = simple.Contour(Input=reader)
    surface.ContourBy = ["POINTS", "ImageFile"]
    surface.Isosurfaces = [ISO]
    surface.ComputeNormals = 0
    surface.ComputeScalars = 0
    simple.SaveData(OUT, proxy=surface, DataMode="Appended", EncodeAppendedData=0, CompressorType="None")
    told = surface.GetDataInformation()
    return told.GetNumberOfPoints(), told.GetNumberOfCells()


def way():
    """The function that makes the surface, its modules loaded."""
    if WAY == "skimage":
        import numpy
        from skimage.measure import marching_cubes
        return lambda: skimage_slabs(numpy, marching_cubes)
    if WAY == "paraview":
        from paraview import simple
        return lambda: paraview(simple)
    vtk = vtk_modules()
    if WAY == "vtk_slabs":
        return lambda: vtk_slabs(vtk)
    return lambda: vtk_streamed(vtk, PIECES if WAY == "vtk_pieces" else 1)


def main():
    make = way()
    begin, cpu_begin = time.perf_counter(), time.process_time()
    vertices, triangles = make()
    told = {"ms": 1e3 * (time.perf_counter() - begin), "vertices": vertices, "triangles": triangles}
    if WAY != "paraview":
        told["cpu_ms"] = 1e3 * (time.process_time() - cpu_begin)
    print(json.dumps(told))


if __name__ == "__main__":
    main()
