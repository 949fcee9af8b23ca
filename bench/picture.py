#!/usr/bin/env python3
r"""Renders PLY meshes side by side into a PNG: the README's picture.

    for field in tangle gyroid marschner-lobb; do
        tetracubes generate $field --dims 256,256,256 --type f32 -o $field.nrrd
        tetracubes extract $field.nrrd --iso 127.5 --normals -o $field.ply
    done
    xvfb-run -a /usr/bin/python3 bench/picture.py tangle.ply gyroid.ply marschner-lobb.ply \
        -o bench/pictures/surfaces.png

Needs VTK (Debian: python3-vtk9) and, without a display, Xvfb (Debian: xvfb, xauth, libgl1-mesa-dri).
"""
import argparse

import vtk

COLOURS = [(0.93, 0.55, 0.24), (0.25, 0.56, 0.78), (0.42, 0.66, 0.40)]  # outside of the surface, mesh by mesh
INSIDE = (0.93, 0.90, 0.84)
MARGIN = 0.64  # around a mesh of unit size: the diagonal of its box has to fit


def surface(path, colour):
    """Actor of a PLY file, centred, of unit size."""
    reader = vtk.vtkPLYReader()
    reader.SetFileName(path)
    reader.Update()
    mesh = reader.GetOutput()
    if mesh.GetNumberOfPolys() == 0:
        raise SystemExit(f"{path}: no triangles; give a PLY file that the tool wrote")
    bounds = mesh.GetBounds()
    size = max(bounds[2 * axis + 1] - bounds[2 * axis] for axis in range(3))
    place = vtk.vtkTransform()
    place.Scale(1 / size, 1 / size, 1 / size)
    place.Translate(*(-(bounds[2 * axis] + bounds[2 * axis + 1]) / 2 for axis in range(3)))
    mapper = vtk.vtkPolyDataMapper()
    mapper.SetInputConnection(reader.GetOutputPort())
    mapper.ScalarVisibilityOff()
    actor = vtk.vtkActor()
    actor.SetMapper(mapper)
    actor.SetUserTransform(place)
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


def panel(path, index, count):
    """Renderer of one mesh, in its part of the window."""
    renderer = vtk.vtkRenderer()
    renderer.SetViewport(index / count, 0, (index + 1) / count, 1)
    renderer.SetBackground(1, 1, 1)
    renderer.AddActor(surface(path, COLOURS[index % len(COLOURS)]))
    renderer.SetUseFXAA(True)
    camera = renderer.GetActiveCamera()
    camera.ParallelProjectionOn()
    camera.SetFocalPoint(0, 0, 0)
    camera.SetPosition(0.9, -1.7, 1.5)
    camera.SetViewUp(0, 0, 1)
    camera.SetParallelScale(0.5 * (1 + MARGIN))
    renderer.ResetCameraClippingRange()
    lights = vtk.vtkLightKit()
    lights.AddLightsToRenderer(renderer)
    return renderer


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("mesh", nargs="+", help="PLY files")
    parser.add_argument("-o", "--output", required=True, help="PNG to write")
    parser.add_argument("--height", type=int, default=360, help="of the picture, in pixels")
    arguments = parser.parse_args()
    count = len(arguments.mesh)
    window = vtk.vtkRenderWindow()
    window.SetOffScreenRendering(1)
    window.SetMultiSamples(0)
    window.SetSize(arguments.height * count, arguments.height)
    for index, path in enumerate(arguments.mesh):
        window.AddRenderer(panel(path, index, count))
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
