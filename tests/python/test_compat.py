"""scikit-image's function: names, shapes, types, errors. packages.py compares it with scikit-image itself."""
import inspect

import numpy as np
import pytest
from conftest import signed_volume
from tetracubes.compat import marching_cubes


@pytest.fixture(autouse=True)
def _reference(monkeypatch):
    monkeypatch.setenv("TETRACUBES_DEVICE", "no such device")


pytestmark = pytest.mark.filterwarnings("ignore:.*reference engine:RuntimeWarning")


def test_signature():
    assert list(inspect.signature(marching_cubes).parameters) == [
        "volume", "level", "spacing", "gradient_direction", "step_size", "allow_degenerate", "method", "mask"]


def test_return_values(ball):
    verts, faces, normals, values = marching_cubes(ball, 0, spacing=(3, 2, 1))
    assert (verts.dtype, faces.dtype, normals.dtype, values.dtype) == ("f8", "i4", "f4", "f4")
    assert marching_cubes(ball, 0)[0].dtype == "f4"
    assert verts.shape == normals.shape == (len(values), 3) and faces.shape[1] == 3
    np.testing.assert_allclose(np.linalg.norm(verts / [3, 2, 1] - [12, 14, 16], axis=1), 9, atol=0.05)
    assert (values >= 0).all() and values.max() < 1.8
    turned = marching_cubes(ball, 0, spacing=(3, 2, 1), gradient_direction="ascent")[1]
    assert signed_volume(verts, faces) < 0  # as there
    assert signed_volume(verts, faces) == pytest.approx(-signed_volume(verts, turned), rel=1e-9)


def test_default_level(ball):
    middle = (float(ball.min()) + float(ball.max())) / 2
    np.testing.assert_array_equal(marching_cubes(ball)[0], marching_cubes(ball, middle)[0])


def test_steps_and_masks(ball):
    verts = marching_cubes(ball, 0, step_size=2)[0]
    np.testing.assert_allclose(np.linalg.norm(verts - [12, 14, 16], axis=1), 9, atol=0.2)
    half = np.zeros(ball.shape, bool)
    half[:, :, 16:] = True
    assert marching_cubes(ball, 0, mask=half)[0][:, 2].min() == 16


def test_degenerate_triangles():
    volume = np.zeros((5, 5, 5), np.uint8)
    volume[2, 2, 2] = 1
    assert len(marching_cubes(volume, 1)[1]) > len(marching_cubes(volume, 1, allow_degenerate=False)[1]) == 0


@pytest.mark.parametrize("error, text, options", [
    (ValueError, "level must be within", {"level": 100}), (RuntimeError, "No surface", {"volume": np.ones((3, 3, 3))}),
    (ValueError, "lewiner", {"method": "dual"}), (ValueError, "gradient_direction", {"gradient_direction": "up"}),
    (ValueError, "three floats", {"spacing": (1, 2)}), (ValueError, "step_size", {"step_size": 0}),
    (ValueError, "same shape", {"mask": np.ones((2, 2, 2))}), (ValueError, "3D", {"volume": np.ones((3, 3))}),
])
def test_errors(ball, error, text, options):
    with pytest.raises(error, match=text):
        marching_cubes(**{"volume": ball, **options})
