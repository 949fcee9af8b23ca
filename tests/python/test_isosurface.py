"""Surfaces of volumes: the tool's bytes, in the axes of the array; what is missing; files; parts joined."""
import gc
import pickle

import numpy as np
import pytest
import tetracubes
from conftest import signed_volume


@pytest.mark.parametrize("method", ["tetra", "hybrid", "snap"])
@pytest.mark.parametrize("dtype", ["u1", "i1", "u2", "i2", "u4", "i4", "f4", "f8"])
def test_hash_is_the_tools(ball, surface, tool, method, dtype):
    volume = (10 * ball + 120).clip(0, 120).astype(dtype)
    mesh = surface(volume, 70.5, method=method, spacing=(3, 2, 0.5), origin=(7, 8, 9))
    report = tool(volume, "--iso", "70.5", "--method", method, "--spacing", "0.5,2,3", "--origin", "9,8,7")
    assert len(mesh.vertices) == report["surfaces"][0]["vertices"] > 100
    assert mesh.active_cells == report["surfaces"][0]["active_cells"]
    assert mesh.hash == report["surfaces"][0]["hash"]


def test_closed(ball):
    """The half of a ball that the volume's border leaves."""
    half = ball[len(ball) // 2:]
    mesh = tetracubes.isosurface(half, 0.0, closed=True)
    edges = np.sort(mesh.faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    assert (np.unique(edges, axis=0, return_counts=True)[1] == 2).all()
    assert mesh.hash == tetracubes.isosurface(half, 0.0, closed=True, engine="reference").hash
    assert len(tetracubes.isosurface(half, 0.0).faces) < len(mesh.faces)
    with tetracubes.Grid(half) as grid:
        assert grid.count(0.0, closed=True).faces == len(mesh.faces) > grid.count(0.0).faces


@pytest.mark.parametrize("ending", ["ply", "vtp", "stl", "obj"])
def test_files_are_the_tools(ball, surface, tool, tmp_path, ending):
    normals = [] if ending == "stl" else ["--normals"]
    tool(ball, "--iso", "0", *normals, "-o", f"tool.{ending}")
    surface(normals=bool(normals)).save(tmp_path / f"own.{ending}")
    assert (tmp_path / f"own.{ending}").read_bytes() == (tmp_path / f"tool.{ending}").read_bytes()


def test_axes(surface):
    """In either order of axes the sphere lies where it is, and faces wind counter-clockwise seen from outside."""
    options = {"normals": True, "carry": {"z": np.broadcast_to(np.arange(25.0)[:, None, None], (25, 29, 33))}}
    zyx = surface(spacing=(3, 2, 1), origin=(5, 0, 0), **options)
    xyz = surface(spacing=(1, 2, 3), origin=(0, 0, 5), axes="xyz", **options)
    assert zyx.hash == xyz.hash
    np.testing.assert_allclose(zyx.vertices.mean(axis=0), [41, 28, 16], atol=0.05)
    np.testing.assert_allclose(xyz.vertices.mean(axis=0), [16, 28, 41], atol=0.05)
    np.testing.assert_allclose(zyx.vertices[:, 0], 3 * zyx.values["z"] + 5, rtol=1e-5)
    for mesh in zyx, xyz:
        assert signed_volume(mesh.vertices, mesh.faces) == pytest.approx(6 * 4 / 3 * np.pi * 9 ** 3, rel=0.02)
        outward = mesh.vertices - mesh.vertices.mean(axis=0)
        assert (np.einsum("ij,ij->i", mesh.normals, outward) > 0).all()
        np.testing.assert_allclose(np.linalg.norm(mesh.normals, axis=1), 1, atol=1e-5)


def test_direction(surface):
    """Columns of direction are where axes lead, in the order of axes."""
    turned = np.array([[0, 1, 0], [1, 0, 0], [0, 0, -1.0]])
    plain, mesh = surface(spacing=(3, 2, 1)), surface(spacing=(3, 2, 1), direction=turned)
    np.testing.assert_allclose(mesh.vertices, plain.vertices @ turned.T, atol=1e-4)
    assert signed_volume(mesh.vertices, mesh.faces) > 0


def test_far_from_zero(surface):
    """Positions are relative to the origin; vertices are not, in double precision."""
    near, far = surface(spacing=0.001), surface(spacing=0.001, origin=(0, 0, 5e6))
    assert near.vertices.dtype == np.float32 and not near.origin.any()
    assert far.vertices.dtype == np.float64 and far.origin[0] > 4e6
    np.testing.assert_allclose(far.vertices - near.vertices, np.broadcast_to([0, 0, 5e6], near.vertices.shape),
                               atol=1e-6)


def test_outputs_own_their_memory(surface):
    """No copy is made, and arrays live longer than mesh and grid; they may be written to."""
    mesh = surface(normals=True)
    assert np.shares_memory(mesh.vertices, mesh.positions) and np.shares_memory(mesh.faces, mesh.triangles)
    vertices, faces, wanted = mesh.vertices, mesh.faces, mesh.vertices.copy()
    del mesh
    gc.collect()
    surface()
    np.testing.assert_array_equal(vertices, wanted)
    assert faces.dtype == np.uint32 and faces.max() == len(vertices) - 1
    vertices *= 2
    faces += 1


def test_mesh_can_be_pickled(surface):
    mesh = surface(normals=True)
    again = pickle.loads(pickle.dumps(mesh))
    assert again.hash == mesh.hash and (again.normals == mesh.normals).all()


def test_carry(ball, surface):
    z, y, x = (array.astype(np.float32) for array in np.mgrid[:25, :29, :33])
    mesh = surface(carry={"z": z, "xyz": np.stack([x, y, z], axis=-1)})
    np.testing.assert_allclose(mesh.values["z"], mesh.vertices[:, 0], atol=1e-5)
    np.testing.assert_allclose(mesh.values["xyz"], mesh.vertices[:, ::-1], atol=1e-5)
    with pytest.raises(ValueError, match=r"carry\['z'\] has the shape \(25, 29\), and the grid \(25, 29, 33\)"):
        surface(carry={"z": z[..., 0]})


def test_carried_values_are_written(surface, tmp_path):
    mesh = surface(carry={"heat": np.ones((25, 29, 33)), "flow": np.zeros((25, 29, 33, 2), "f4")})
    mesh.save(tmp_path / "a.ply")
    head = (tmp_path / "a.ply").read_bytes()[:600]
    assert b"property float heat\n" in head and b"property float flow_1\n" in head
    with pytest.raises(ValueError, match="(?i)stl"):
        mesh.save(tmp_path / "a.stl")


def test_files_far_from_zero(ball, tmp_path):
    """STL holds float32: without origin_at it counts from the mesh's origin."""
    mesh = tetracubes.isosurface(ball, 0.0, origin=(5e6, 0, 0), axes="zyx")
    corners = np.dtype([("normal", "<3f4"), ("corners", "<9f4"), ("more", "<u2")])

    def lowest():
        return np.frombuffer((tmp_path / "a.stl").read_bytes()[84:], corners)["corners"].reshape(-1, 3).min(axis=0)

    with pytest.warns(RuntimeWarning, match="relative to"):
        mesh.save(tmp_path / "a.stl")
    np.testing.assert_array_equal(lowest(), mesh.positions.min(axis=0))
    mesh.save(tmp_path / "a.stl", origin_at=mesh.origin - [1, 2, 3])
    np.testing.assert_allclose(lowest(), mesh.positions.min(axis=0) + [1, 2, 3], rtol=1e-6)
    with pytest.raises(ValueError, match="three finite numbers"):
        mesh.save(tmp_path / "a.stl", origin_at=(0, 0))


def test_save_fails(surface, tmp_path):
    with pytest.raises(ValueError, match="ply"):
        surface().save(tmp_path / "a.gltf")
    with pytest.raises(ValueError, match="name the format by format=$"):
        surface().save(tmp_path / "a")
    with pytest.raises(ValueError, match="VTKHDF, for which libhdf5 was not built in: write vtp"):
        surface().save(tmp_path / "a.vtkhdf")
    with pytest.raises(OSError, match="nowhere"):
        surface().save(tmp_path / "nowhere" / "a.ply")
    surface().save(tmp_path / "a.dat", format="ply")
    assert [path.name for path in tmp_path.iterdir()] == ["a.dat"]


def test_missing(ball, surface):
    """mask, nodata, masked arrays, NaN: one mechanism."""
    holes = np.random.default_rng(1).random(ball.shape) < 0.05
    wanted = surface(np.where(holes, np.nan, ball))
    assert 0 < len(wanted.faces) < len(surface().faces)
    assert surface(mask=~holes).hash == wanted.hash
    assert surface(mask=(~holes).astype(np.int64)).hash == wanted.hash
    assert surface(mask=np.where(holes, np.nan, 1)).hash == wanted.hash
    assert surface(np.where(holes, np.float32(-99.9), ball), nodata=-99.9).hash == wanted.hash
    assert surface(np.ma.array(ball, mask=holes)).hash == wanted.hash
    half = holes & (np.arange(33) < 16)
    assert surface(np.ma.array(ball, mask=half), mask=~(holes & ~half)).hash == wanted.hash
    assert surface(np.ma.array(ball)).hash == surface().hash


def test_grid(ball):
    with tetracubes.Grid(ball, engine="reference") as grid:
        meshes = [grid.extract(level) for level in (-1, 0, 1)]
        counts = grid.count(0)
        assert grid.count(0, method="hybrid").faces < counts.faces
        assert grid.count(0, normals=True).mesh_bytes == counts.mesh_bytes + 12 * counts.vertices
    with tetracubes.Grid(ball[:14], engine="reference") as grid:
        closed, sizes = grid.extract(0, closed=True), grid.count(0, closed=True)
        assert sizes[:2] == (len(closed.vertices), len(closed.faces)) and sizes.faces > grid.count(0).faces
    sizes = [len(mesh.faces) for mesh in meshes]
    assert sizes == sorted(sizes, reverse=True)
    assert counts == (len(meshes[1].vertices), sizes[1], meshes[1].active_cells, counts.mesh_bytes)
    with pytest.raises(ValueError, match="closed"):
        grid.extract(0)
    grid.close()


def test_no_surface(surface):
    with pytest.warns(RuntimeWarning, match="at 1000000.0 is empty"):
        mesh = surface(level=1e6, normals=True, carry={"a": np.zeros((25, 29, 33))})
    assert mesh.vertices.shape == mesh.faces.shape == mesh.normals.shape == (0, 3) and mesh.values["a"].shape == (0,)


@pytest.mark.parametrize("options, text", [
    ({"level": np.nan}, "isovalue"), ({"volume": np.zeros((4, 4))}, "2 dimensions, not 3"),
    ({"volume": np.zeros((4, 1, 4))}, "at least 2|one sample|from 2"), ({"method": "cubes"}, "tetra, hybrid, snap"),
    ({"method": "snap", "snap": 0.7}, "0.5"), ({"spacing": (1, 2)}, "spacing"), ({"spacing": (1, 0, 1)}, "spacing"),
    ({"origin": np.inf}, "inf is beyond float32"), ({"direction": np.eye(2)}, "direction"), ({"axes": "zxy"}, "'zyx' or 'xyz'"),
    ({"mask": np.ones((3, 3, 3))}, "mask has the shape"), ({"max_memory": -1}, "max_memory"),
    ({"volume": np.zeros((4, 4, 4), complex)}, "complex128"), ({"volume": "text"}, "dimensions|no array"),
    ({"volume": [[[1], [2, 3]]]}, "no array"), ({"volume": np.full((4, 4, 4), 1 << 40)}, "beyond 32 bits"),
])
def test_bad_input(surface, options, text):
    """A ValueError with a sentence."""
    with pytest.raises(ValueError, match=text):
        surface(**options)


def test_bad_engine(ball):
    with pytest.raises(ValueError, match="auto, opencl, reference"):
        tetracubes.isosurface(ball, 0, engine="cuda")


@pytest.mark.parametrize("method", ["tetra", "hybrid", "snap"])
@pytest.mark.parametrize("seed", range(12))
def test_parts(method, seed):
    """Parts joined are one piece, byte for byte: with ties, missing samples, normals, fields, far from zero."""
    random = np.random.default_rng(seed)
    shape = random.integers(2, 30), random.integers(2, 12), random.integers(2, 140)
    volume, level = random.random(shape).astype(np.float32), 0.5
    options = {"method": method, "normals": True, "carry": {"a": random.random(shape)}, "engine": "reference"}
    if seed % 2:
        volume, level = random.integers(0, 5, shape).astype(np.uint8), 2
    if seed % 4 == 2:
        volume[random.random(shape) < 0.1] = np.nan
    if seed % 4 == 3:
        options["nodata"] = 3
    if seed % 3 == 0:
        options["closed"] = True
    if seed >= 4:
        options["mask"] = random.random(shape) < 0.9
    if seed >= 8:
        options.update(origin=(1e6, 2e6, 3e6), spacing=(0.1, 0.2, 0.3))
    whole = tetracubes.isosurface(volume, level, **options)
    for planes in 1, 8, 12:
        joined = tetracubes.isosurface_by_parts(volume, level, planes=planes, **options)
        assert joined.hash == whole.hash and joined.active_cells == whole.active_cells
        assert joined.normals.tobytes() == whole.normals.tobytes()
        assert joined.values["a"].tobytes() == whole.values["a"].tobytes()
        assert (joined.origin == whole.origin).all()


def test_mesh_with_a_face_too_many(ball, tmp_path):
    mesh = tetracubes.isosurface(ball, 0, engine="reference")
    mesh.triangles = mesh.triangles + np.uint32(1)
    for use in mesh.picture, lambda: mesh.save(tmp_path / "a.ply"), lambda: mesh.hash:
        with pytest.raises(ValueError, match="a face has vertex"):
            use()
    assert not any(tmp_path.iterdir())


def test_parts_are_read_by_parts(ball):
    """No more planes are read at once than asked for and the halo."""
    class Slices:
        shape, dtype, read = ball.shape, ball.dtype, []

        def __getitem__(self, which):
            self.read.append(which.stop - which.start)
            return ball[which]

    told = []
    mesh = tetracubes.isosurface_by_parts(Slices(), 0, planes=4, engine="reference",
                                          progress=lambda stage, fraction: told.append(fraction))
    assert mesh.hash == tetracubes.isosurface(ball, 0, engine="reference").hash
    assert max(Slices.read) == 10 and len(Slices.read) == 7 and 0 <= min(told) <= max(told) <= 1
    with pytest.raises(ValueError, match="method"):
        tetracubes.isosurface_by_parts(ball, 0, method="smooth")
    with pytest.raises(ValueError, match="planes"):
        tetracubes.isosurface_by_parts(ball, 0, planes=0)
