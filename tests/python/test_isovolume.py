"""Interval volumes of arrays: their volume, fields, axes; both engines; what is refused."""
import pathlib
import subprocess

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


def test_save(ramp, tmp_path):
    """The tool's file, byte for byte, also far from zero; nothing else is written."""
    np.save(tmp_path / "ramp.npy", ramp)
    for origin in (0, 1e7):
        tetracubes.isovolume(ramp, 1.5, 4, origin=origin).save(tmp_path / "own.vtu")
        subprocess.run([pathlib.Path(tetracubes.__file__).parent / "tetracubes", "isovolume", tmp_path / "ramp.npy", "--range",
                        "1.5,4", "--origin", f"{origin},{origin},{origin}", "--engine", "reference", "--quiet",
                        "-o", tmp_path / "tool.vtu"], check=True)
        assert (tmp_path / "own.vtu").read_bytes() == (tmp_path / "tool.vtu").read_bytes()
    part = tetracubes.isovolume(ramp, 1.5, 4, carry={"heat": ramp, "flow": np.stack([ramp, -ramp], -1)})
    part.save(tmp_path / "named", format="vtu")
    content = (tmp_path / "named").read_bytes()
    assert b'Name="flow" NumberOfComponents="2"' in content
    assert all(content.count(part.values[name].tobytes()) == 1 for name in ("heat", "flow"))
    for name, how, match in (("a.vtk", {}, r"end in \.vtu, or name the format by format=$"),
                             ("a.vtu", {"format": "ply"}, "written as vtu")):
        with pytest.raises(ValueError, match=match):
            part.save(tmp_path / name, **how)
    with pytest.raises(OSError, match="nowhere"):
        part.save(tmp_path / "nowhere" / "a.vtu")
    part.tetrahedra[0, 0] = len(part.positions)
    with pytest.raises(ValueError, match="a tetrahedron has vertex"):
        part.save(tmp_path / "bad.vtu")
    assert sorted(path.name for path in tmp_path.iterdir()) == ["named", "own.vtu", "ramp.npy", "tool.vtu"]


def test_refusals(ramp):
    for low, high in ((2, 1), (None, None), (np.nan, 1)):
        with pytest.raises(ValueError):
            tetracubes.isovolume(ramp, low, high)
    with pytest.raises(ValueError, match="shape"):
        tetracubes.isovolume(ramp, 1, 2, carry={"f": ramp[1:]})
