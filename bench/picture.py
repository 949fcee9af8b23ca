#!/usr/bin/env python3
r"""Renders meshes side by side into a PNG: the README's pictures.

PLY files are surfaces; VTP files those of label maps, a colour for each label; VTU files interval volumes, of which the
part behind a plane through the middle is shown, so that the tetrahedra are seen.

    for field in tangle gyroid marschner-lobb; do
        tetracubes generate $field --dims 256,256,256 --type f32 -o $field.nrrd
        tetracubes extract $field.nrrd --iso 127.5 --normals -o $field.ply
    done
    xvfb-run -a /usr/bin/python3 bench/picture.py tangle.ply gyroid.ply marschner-lobb.ply \
        -o bench/pictures/surfaces.png

and the paper's blunt fin, with the fin and the plate that it stands on:

    fin=$TETRACUBES_DATA/curvilinear/bluntfin
    tetracubes extract ${fin}xyz.bin ${fin}q.bin --field density --iso 2 --normals -o fin.ply
    xvfb-run -a /usr/bin/python3 bench/picture.py fin.ply --walls ${fin}xyz.bin --view=-1.4,1.8,0.9 --zoom 1.1 \
        --aspect 1.4 --height 420 -o bench/pictures/bluntfin.png

and label maps and interval volumes, of the tool's page:

    tetracubes labels $TETRACUBES_DATA/uniform/frogtissue.mhd -o frog.vtp --labels 2,3,4,5,6,7,8,9,10,11,12,13,14
    tetracubes generate tangle --dims 20,20,20 --type f32 -o tangle.nrrd
    tetracubes isovolume tangle.nrrd --range 100,124 -o tangle.vtu
    xvfb-run -a /usr/bin/python3 bench/picture.py frog.vtp tangle.vtu --zoom 1.3 --height 320 -o bench/pictures/labels-volume.png

Needs VTK (Debian: python3-vtk9, with Xvfb where there is no display: xvfb, xauth, libgl1-mesa-dri; or a wheel, which
draws without one: bench/peers-setup).
"""
import argparse
import os

import vtk

COLOURS = [(0.93, 0.55, 0.24), (0.25, 0.56, 0.78), (0.42, 0.66, 0.40)]  # outside of the surface, mesh by mesh
INSIDE = (0.93, 0.90, 0.84)
WALL, WALL_LINES = (0.80, 0.82, 0.85), (0.66, 0.69, 0.74)
WALL_REACH = 0.45  # around a mesh, of the size of its box
EDGES = (0.35, 0.30, 0.26)  # of tetrahedra
CUT = (0, -1, 0)  # away from what is left of a volume
MARGIN = 0.64  # around a mesh of unit size: the diagonal of its box has to fit


READERS = {".ply": vtk.vtkPLYReader, ".vtp": vtk.vtkXMLPolyDataReader, ".vtu": vtk.vtkXMLUnstructuredGridReader}


def kind_of(path):
    return os.path.splitext(path)[1]


def read(path):
    """The triangles of a file, or the faces of the tetrahedra that are shown of one."""
    if kind_of(path) not in READERS:
        raise SystemExit(f"{path}: give PLY, VTP or VTU files that the tool wrote")
    reader = READERS[kind_of(path)]()
    reader.SetFileName(path)
    reader.Update()
    mesh = cut_open(reader.GetOutput()) if kind_of(path) == ".vtu" else reader.GetOutput()
    if mesh.GetNumberOfPolys() == 0:
        raise SystemExit(f"{path}: no triangles; give a file that the tool wrote")
    return mesh


def cut_open(volume):
    """The faces of the tetrahedra behind a plane through the middle that is turned to the camera."""
    plane, behind, faces = vtk.vtkPlane(), vtk.vtkExtractGeometry(), vtk.vtkGeometryFilter()
    plane.SetOrigin(*volume.GetCenter())
    plane.SetNormal(*CUT)
    behind.SetInputData(volume)
    behind.SetImplicitFunction(plane)
    behind.ExtractInsideOn()
    faces.SetInputConnection(behind.GetOutputPort())
    faces.Update()
    return faces.GetOutput()


def read_walls(path):
    """The faces j = 0 and k = 0 of a Plot3D grid of one block."""
    reader = vtk.vtkMultiBlockPLOT3DReader()
    reader.SetXYZFileName(path)
    reader.AutoDetectFormatOn()
    reader.Update()
    grid = reader.GetOutput().GetBlock(0)
    if grid is None:
        raise SystemExit(f"{path}: no Plot3D grid")
    faces = vtk.vtkAppendPolyData()
    for axis in (1, 2):
        extent = list(grid.GetExtent())
        extent[2 * axis + 1] = extent[2 * axis]
        face = vtk.vtkStructuredGridGeometryFilter()
        face.SetInputData(grid)
        face.SetExtent(*extent)
        face.Update()
        faces.AddInputData(face.GetOutput())
    faces.Update()
    return faces.GetOutput()


def clipped(walls, mesh):
    """To the box of the mesh, widened."""
    bounds = vtk.vtkBoundingBox(mesh.GetBounds())
    bounds.Inflate(WALL_REACH * bounds.GetMaxLength())
    low, high = bounds.GetMinPoint(), bounds.GetMaxPoint()
    box = vtk.vtkBox()
    box.SetBounds(low[0], high[0], low[1], high[1], low[2], high[2])
    clip = vtk.vtkClipPolyData()
    clip.SetInputData(walls)
    clip.SetClipFunction(box)
    clip.InsideOutOn()
    clip.Update()
    return clip.GetOutput()


def frame(mesh):
    """Transform that centres it and makes it of unit size."""
    bounds = mesh.GetBounds()
    centre = [(bounds[2 * axis] + bounds[2 * axis + 1]) / 2 for axis in range(3)]
    size = max(bounds[2 * axis + 1] - bounds[2 * axis] for axis in range(3))
    transform = vtk.vtkTransform()
    transform.Scale(1 / size, 1 / size, 1 / size)
    transform.Translate(*(-c for c in centre))
    return transform


def actor_of(mesh, colour, transform):
    mapper = vtk.vtkPolyDataMapper()
    mapper.SetInputData(mesh)
    mapper.ScalarVisibilityOff()
    actor = vtk.vtkActor()
    actor.SetMapper(mapper)
    actor.SetUserTransform(transform)
    front = actor.GetProperty()
    front.SetColor(*colour)
    front.SetSpecular(0.25)
    front.SetSpecularPower(30)
    front.SetAmbient(0.12)
    front.SetInterpolationToPhong()
    back = vtk.vtkProperty()
    back.DeepCopy(front)
    back.SetColor(*INSIDE)
    actor.SetBackfaceProperty(back)
    return actor


def colour_labels(actor, mesh):
    """A colour for the first label of each triangle, which it winds about."""
    table, colours = vtk.vtkLookupTable(), vtk.vtkColorSeries()
    colours.SetColorScheme(vtk.vtkColorSeries.BREWER_QUALITATIVE_SET3)
    colours.BuildLookupTable(table, vtk.vtkColorSeries.ORDINAL)
    table.SetTableRange(0, colours.GetNumberOfColors() - 1)
    labels = mesh.GetCellData().GetArray("BoundaryLabels")
    first, known = vtk.vtkIntArray(), {}
    for n in range(labels.GetNumberOfTuples()):
        first.InsertNextValue(known.setdefault(labels.GetComponent(n, 0), len(known) % colours.GetNumberOfColors()))
    first.SetName("colour")
    mesh.GetCellData().SetScalars(first)
    mapper = actor.GetMapper()
    mapper.SetScalarModeToUseCellData()
    mapper.SetLookupTable(table)
    mapper.UseLookupTableScalarRangeOn()
    mapper.ScalarVisibilityOn()


def show_edges(actor):
    """Of tetrahedra, whose faces are flat."""
    for side in (actor.GetProperty(), actor.GetBackfaceProperty()):
        side.EdgeVisibilityOn()
        side.SetEdgeColor(*EDGES)
        side.SetLineWidth(0.7)
        side.SetInterpolationToFlat()


def walls_of(mesh, transform):
    """Faint, lined by the grid."""
    actor = actor_of(mesh, WALL, transform)
    for side in (actor.GetProperty(), actor.GetBackfaceProperty()):
        side.SetColor(*WALL)
        side.SetOpacity(0.45)
        side.SetSpecular(0)
        side.EdgeVisibilityOn()
        side.SetEdgeColor(*WALL_LINES)
    return actor


def panel(arguments, index):
    """Renderer of one mesh, in its part of the window."""
    count = len(arguments.mesh)
    mesh = read(arguments.mesh[index])
    transform = frame(mesh)
    renderer = vtk.vtkRenderer()
    renderer.SetViewport(index / count, 0, (index + 1) / count, 1)
    renderer.SetBackground(1, 1, 1)
    actor = actor_of(mesh, COLOURS[index % len(COLOURS)], transform)
    if kind_of(arguments.mesh[index]) == ".vtp":
        colour_labels(actor, mesh)
    if kind_of(arguments.mesh[index]) == ".vtu":
        show_edges(actor)
    renderer.AddActor(actor)
    if arguments.walls:
        renderer.AddActor(walls_of(clipped(read_walls(arguments.walls), mesh), transform))
    renderer.SetUseFXAA(True)
    camera = renderer.GetActiveCamera()
    camera.ParallelProjectionOn()
    camera.SetFocalPoint(0, 0, 0)
    camera.SetPosition(*arguments.view)
    camera.SetViewUp(0, 0, 1)
    camera.SetParallelScale(0.5 * (1 + MARGIN) / arguments.zoom)
    renderer.ResetCameraClippingRange()
    lights = vtk.vtkLightKit()
    lights.AddLightsToRenderer(renderer)
    return renderer


def direction(text):
    numbers = tuple(map(float, text.split(",")))
    if len(numbers) != 3:
        raise ValueError(text)
    return numbers


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("mesh", nargs="+", help="PLY, VTP or VTU files")
    parser.add_argument("-o", "--output", required=True, help="PNG to write")
    parser.add_argument("--height", type=int, default=360, help="of the picture, in pixels")
    parser.add_argument("--aspect", type=float, default=1.0, help="width of a mesh's part to its height")
    parser.add_argument("--walls", metavar="GRID", help="Plot3D grid, of which the faces j = 0 and k = 0 are drawn too")
    parser.add_argument("--view", type=direction, default=(0.9, -1.7, 1.5), metavar="X,Y,Z", help="camera's direction")
    parser.add_argument("--zoom", type=float, default=1.0)
    arguments = parser.parse_args()
    count = len(arguments.mesh)
    window = vtk.vtkRenderWindow()
    window.SetOffScreenRendering(1)
    window.SetMultiSamples(0)
    window.SetSize(round(arguments.height * arguments.aspect) * count, arguments.height)
    for index in range(count):
        window.AddRenderer(panel(arguments, index))
    window.Render()
    picture = vtk.vtkWindowToImageFilter()
    picture.SetInput(window)
    picture.ReadFrontBufferOff()
    writer = vtk.vtkPNGWriter()
    writer.SetFileName(arguments.output)
    writer.SetInputConnection(picture.GetOutputPort())
    writer.SetCompressionLevel(9)
    writer.Write()


if __name__ == "__main__":
    main()
