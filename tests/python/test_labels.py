"""Surfaces of label maps: those of the tool's call, each label closed, bad input refused."""
import numpy as np
import pytest
import tetracubes


def blocks(dtype="u1"):
    volume = np.zeros((12, 13, 14), dtype)
    volume[3:9, 3:10, 3:7] = 3
    volume[3:9, 3:10, 7:11] = 7
    return volume


def volume_of(mesh):
    a, b, c = (mesh.positions[mesh.triangles[:, n]].astype("f8") for n in range(3))
    return np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6


@pytest.mark.parametrize("engine", ["auto", "reference"])
def test_each_label_is_closed(engine):
    mesh = tetracubes.labels(blocks(), smoothing=0, engine=engine)
    assert mesh.boundary_labels.shape == mesh.faces.shape[:1] + (2,)
    assert set(map(tuple, mesh.boundary_labels)) == {(3, 7), (3, 0), (7, 0)}
    for label in (3, 7):
        one = mesh.of_label(label)
        assert (one.boundary_labels[:, 0] == label).all()
        assert one.faces.max() == len(one.vertices) - 1
        assert 0.95 * 168 < volume_of(one) < 168


def test_engines_and_types_agree():
    hashes = {tetracubes.labels(blocks(dtype), engine=engine).hash
              for dtype in ("u1", "i2", "u4", "i8", "f4", "f8") for engine in ("auto", "reference")}
    assert len(hashes) == 1


def test_floats_that_are_no_labels_are_background():
    volume = blocks("f4")
    volume[volume == 0] = -1.5
    volume[0, 0, :2] = np.nan, np.inf
    expected = tetracubes.labels(blocks()).hash
    assert tetracubes.labels(volume).hash == expected
    assert tetracubes.labels(np.where(volume > 0, volume, 0.25), nodata=0.25).hash == expected
    assert tetracubes.labels(np.ma.masked_array(np.nan_to_num(blocks("f8") + 9), blocks() == 0) - 9).hash == expected


def test_choices():
    whole = tetracubes.labels(blocks(), [7], smoothing=0)
    assert set(map(tuple, whole.boundary_labels)) == {(7, 0)}
    assert len(tetracubes.labels(blocks() * 0).faces) == 0
    assert len(tetracubes.labels(np.full((3, 3, 3), 5, "u1")).faces) == 0
    assert volume_of(tetracubes.labels(np.full((3, 3, 3), 5, "u1"), closed=True, smoothing=0)) > 0.8 * 27
    assert tetracubes.isosurface(blocks(), 5).boundary_labels is None


def test_files_have_labels(tmp_path):
    mesh = tetracubes.labels(blocks())
    mesh.save(tmp_path / "m.npz")
    assert (np.load(tmp_path / "m.npz")["boundary_labels"] == mesh.boundary_labels).all()


@pytest.mark.parametrize("bad, says", [(dict(labels=[0]), "above 0"), (dict(labels=[1.5]), "whole numbers"),
                                       (dict(labels=[]), "whole numbers"), (dict(smoothing=1001), "1000"),
                                       (dict(smoothing=-1), "sweeps"), (dict(smoothing=2.5), "sweeps")])
def test_bad_input(bad, says):
    with pytest.raises(ValueError, match=says):
        tetracubes.labels(blocks(), **bad)
    with pytest.raises(ValueError, match="whole numbers below"):
        tetracubes.labels(blocks("f4") / 2)
    with pytest.raises(ValueError, match="whole numbers below"):
        tetracubes.labels(blocks("i8") << 32)
    with pytest.raises(ValueError, match="no labels"):
        tetracubes.isosurface(blocks(), 5).of_label(3)
