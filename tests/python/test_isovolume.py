"""Interval volumes of arrays: their volume, fields, axes; both engines; what is refused."""
import numpy as np
import pytest
import tetracubes


@pytest.fixture(name="ramp")
def make_ramp():
    """Linear along z, so that all volumes and means are known."""
    return np.broadcast_to(np.arange(9, dtype="f4")[:, None, None], (9, 6, 5)).copy()


@pytest.mark.parametrize("low, high, thickness", [(1.5, 4.25, 2.75), (None, 2.5, 2.5), (6, None, 2), (20, 30, 0)])
def test_volume(ramp, low, high, thickness):
    part = tetracubes.isovolume(ramp, low, high, carry={"f": ramp}, spacing=(2, 1, 1))
    assert part.volumes.sum() == pytest.approx(thickness * 2 * 5 * 4, rel=1e-5)
    assert sum(part.counts) == len(part.vertices)
    assert (part.volumes >= 0).all()  # 0 beside samples that equal a bound
    if thickness:
        middle = (low or 0) + thickness / 2
        assert part.mean("f") == pytest.approx(middle, rel=1e-5)
        assert part.vertices[:, 0] / 2 == pytest.approx(part.values["f"], abs=1e-5)


def test_engines(ball):
    parts = [tetracubes.isovolume(ball, -1, 2, engine=engine) for engine in ("auto", "reference")]
    assert parts[0].positions.tobytes() == parts[1].positions.tobytes()
    assert parts[0].tetrahedra.tobytes() == parts[1].tetrahedra.tobytes()
    low, high = (tetracubes.isosurface(ball, level) for level in (-1, 2))
    samples, on_low, on_high = parts[0].counts
    assert (on_low, on_high) == (len(low.vertices), len(high.vertices))
    assert (parts[0].positions[samples:samples + on_low] == low.positions).all()


def test_refusals(ramp):
    for low, high in ((2, 1), (None, None), (np.nan, 1)):
        with pytest.raises(ValueError):
            tetracubes.isovolume(ramp, low, high)
    with pytest.raises(ValueError, match="shape"):
        tetracubes.isovolume(ramp, 1, 2, carry={"f": ramp[1:]})
