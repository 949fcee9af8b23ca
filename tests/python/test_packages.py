"""With the packages that people use it with, from PyPI, and as a wheel: packages.py makes the environment and runs this.

TEST_PACKAGES says that they are there; without it these tests are left out.
"""
import os
from pathlib import Path

import numpy as np
import pytest
import tetracubes
from conftest import signed_volume

if "TEST_PACKAGES" not in os.environ:
    pytest.skip("of the long tier", allow_module_level=True)

DATA = os.environ.get("TETRACUBES_DATA")


def test_is_installed():
    """What is tested is the wheel, not the build."""
    assert "site-packages" in tetracubes.__file__


@pytest.mark.parametrize("direction", ["descent", "ascent"])
@pytest.mark.parametrize("spacing", [(1, 1, 1), (3, 2, 1)])
def test_scikit_image(ball, spacing, direction):
    """A ball has no ambiguous cube: the same vertices, and as many faces that wind the same way."""
    from skimage import measure
    from tetracubes.compat import marching_cubes
    options = {"spacing": spacing, "gradient_direction": direction}
    theirs, ours = measure.marching_cubes(ball, 0.1, **options), marching_cubes(ball, 0.1, **options)
    for their, our in zip(theirs, ours):
        assert their.dtype == our.dtype and their.shape == our.shape
    order = [np.lexsort(np.round(verts, 3).T) for verts in (theirs[0], ours[0])]
    np.testing.assert_allclose(ours[0][order[1]], theirs[0][order[0]], atol=1e-4)
    assert signed_volume(*ours[:2]) == pytest.approx(signed_volume(*theirs[:2]), rel=1e-3)
    outward = [np.einsum("ij,ij->i", normals, verts - verts.mean(axis=0)) > 0 for verts, _, normals, _ in (theirs, ours)]
    assert outward[0].all() and outward[1].all()


def test_trimesh(surface):
    mesh = surface(spacing=(3, 2, 1), normals=True, carry={"one": np.ones((25, 29, 33))})
    made = mesh.to_trimesh()
    assert made.is_watertight and made.is_winding_consistent
    assert made.volume == pytest.approx(signed_volume(mesh.vertices, mesh.faces), rel=1e-5) and made.volume > 0
    assert made.vertex_attributes["one"].shape == (len(mesh.vertices),)
    np.testing.assert_allclose(made.vertices, mesh.vertices[:, ::-1])


def test_pyvista(surface, tmp_path):
    import pyvista
    mesh = surface(spacing=(3, 2, 1), normals=True, carry={"one": np.ones((25, 29, 33))})
    made = mesh.to_pyvista()
    assert made.n_cells == len(mesh.faces) and made.is_manifold and set(made.point_data) == {"one", "Normals"}
    assert made.volume == pytest.approx(signed_volume(mesh.vertices, mesh.faces), rel=1e-4)
    mesh.values.clear()  # which STL and OBJ have no place for
    for ending in "ply", "vtp", "stl", "obj":
        mesh.save(tmp_path / f"a.{ending}")
        read = pyvista.read(tmp_path / f"a.{ending}")
        assert read.n_cells == len(mesh.faces) or ending == "stl"  # of which the reader drops triangles of no area
        np.testing.assert_allclose(read.bounds, made.bounds, atol=1e-3)


def test_meshio(surface, tmp_path):
    import meshio
    mesh = surface(carry={"one": np.ones((25, 29, 33))})
    mesh.to_meshio().write(tmp_path / "a.vtu")
    read = meshio.read(tmp_path / "a.vtu")
    np.testing.assert_array_equal(read.points, mesh.vertices[:, ::-1])
    np.testing.assert_array_equal(read.cells_dict["triangle"], mesh.triangles)
    assert (read.point_data["one"] == 1).all()


def test_cells_of_pyvista_and_meshio(tmp_path):
    """A grid of PyVista's; the same through meshio, and through an Exodus and a gmsh file that meshio writes."""
    import meshio
    import pyvista
    grid = pyvista.ImageData(dimensions=(9, 9, 9)).cast_to_unstructured_grid()
    grid = pyvista.UnstructuredGrid({12: np.array(grid.cell_connectivity).reshape(-1, 8)[:, [0, 1, 3, 2, 4, 5, 7, 6]]},
                                    np.array(grid.points, float))
    values = 3 - np.linalg.norm(grid.points - 4.0, axis=1)
    arrays = grid.celltypes, grid.cell_offsets, grid.cell_connectivity
    wanted = tetracubes.contour_cells(grid.points, arrays, values, 0.1, engine="reference")
    assert signed_volume(wanted.vertices, wanted.faces) > 0
    made = meshio.Mesh(np.array(grid.points), [("hexahedron", grid.cells_dict[12])], point_data={"f": values})
    for name in "a.e", "a.msh", "a.inp", "a.xdmf":
        made.write(tmp_path / name)
        read = meshio.read(tmp_path / name)
        field = read.point_data.get("f", values)
        assert tetracubes.contour_cells(read.points, read.cells, field, 0.1, engine="reference").hash == wanted.hash


@pytest.mark.skipif(not DATA, reason="TETRACUBES_DATA is not set")
def test_exodus():
    """The published Exodus file, as PyVista reads it (meshio knows fields in a variable each alone)."""
    import pyvista
    grid = pyvista.read(Path(DATA) / "unstructured" / "disk_out_ref.ex2").combine()
    mesh = tetracubes.contour_cells(grid.points, (grid.celltypes, grid.cell_offsets, grid.cell_connectivity),
                                    grid["Temp"], 400, carry={"Pres": grid["Pres"]}, engine="reference")
    theirs = grid.contour([400], scalars="Temp")
    np.testing.assert_allclose(np.reshape([mesh.vertices.min(axis=0), mesh.vertices.max(axis=0)], 6, "F"), theirs.bounds,
                               atol=0.05)  # VTK cuts hexahedra otherwise
    assert mesh.to_pyvista().area == pytest.approx(theirs.area, rel=0.01)
    assert np.isfinite(mesh.values["Pres"]).all()


@pytest.mark.parametrize("library", ["dask", "zarr"])
def test_parts(ball, library, tmp_path):
    if library == "dask":
        import dask.array
        volume = dask.array.from_array(ball, chunks=(7, 29, 20))
    else:
        import zarr
        volume = zarr.create_array(tmp_path / "a.zarr", shape=ball.shape, dtype=ball.dtype, chunks=(7, 29, 20))
        volume[...] = ball
    wanted = tetracubes.isosurface(ball, 0, engine="reference", carry={"f": ball})
    joined = tetracubes.isosurface_by_parts(volume, 0, planes=8, engine="reference", carry={"f": volume})
    assert joined.hash == wanted.hash and (joined.values["f"] == wanted.values["f"]).all()
    assert tetracubes.isosurface(volume, 0, engine="reference").hash == wanted.hash


@pytest.fixture
def queue():
    import pyopencl
    try:
        devices = [device for platform in pyopencl.get_platforms() for device in platform.get_devices()]
    except pyopencl.LogicError:
        devices = []
    if not devices:
        pytest.skip("no OpenCL device")
    context = pyopencl.Context(devices[:1])
    return pyopencl.CommandQueue(context)


def test_opencl(ball, queue):
    """Samples in a buffer of pyopencl's, the mesh read back or left in buffers."""
    import pyopencl
    flags = pyopencl.mem_flags
    buffer = pyopencl.Buffer(queue.context, flags.READ_ONLY | flags.COPY_HOST_PTR, hostbuf=np.append(np.float32(9), ball))
    wanted = tetracubes.isosurface(ball, 0.5, spacing=(3, 2, 1), normals=True, engine="reference")
    with tetracubes.Grid.from_opencl(queue.context, queue, buffer, ball.shape, ball.dtype, offset=1,
                                     spacing=(3, 2, 1)) as grid:
        assert grid.extract(0.5).hash == wanted.hash
        mesh = grid.extract_on_device(0.5, normals=True)
        for place, array in (mesh.positions, wanted.positions), (mesh.triangles, wanted.triangles), \
                (mesh.normals, wanted.normals[:, ::-1]):
            read = np.empty_like(array, order="C")
            pyopencl.enqueue_copy(queue, read, place, wait_for=[mesh.event])
            np.testing.assert_array_equal(read, array)
        assert mesh.vertex_count == len(wanted.positions) and not mesh.origin.any()
        empty = grid.extract_on_device(1e6)
        assert empty.positions is empty.triangles is None and empty.vertex_count == 0
    with tetracubes.Grid(ball, engine="reference") as grid, pytest.raises(ValueError, match="from_opencl"):
        grid.extract_on_device(0.5)
    with pytest.raises(ValueError, match="bytes"):
        tetracubes.Grid.from_opencl(queue.context, queue, buffer, (26, 29, 33), "f4")
    with pytest.raises(ValueError, match="dtype"):
        tetracubes.Grid.from_opencl(queue.context, queue, buffer, (3, 3, 3), "f2")
