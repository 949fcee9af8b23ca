"""The examples of host/python/README.md run as they stand; its table has every argument; what is public is described and
typed."""
import inspect
import os
import re
from pathlib import Path

import numpy as np
import pytest
import tetracubes

PAGE = (Path(__file__).resolve().parents[2] / "host" / "python" / "README.md").read_text(encoding="utf-8")
EXAMPLES = re.findall(r"```python\n(.*?)```", PAGE, re.DOTALL)
OTHERS = ("to_pyvista", "import meshio", "import zarr", "import pyopencl", "import tqdm", "from tqdm")


def test_examples(tmp_path, monkeypatch):
    """Those that need other packages only where these are there; pictures only where the package was built with PNG."""
    has_png = tetracubes.isosurface(np.eye(3)[None].repeat(3, 0), 0.5, engine="reference")._repr_png_() is not None
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("PYOPENCL_CTX", "0")
    names = {}
    ran = 0
    for example in EXAMPLES:
        if "TEST_PACKAGES" not in os.environ and any(other in example for other in OTHERS):
            continue
        if "TEST_PACKAGES" in os.environ:
            prepare(tmp_path)
        lines = [line for line in example.split("\n") if has_png or ".png" not in line]
        exec(compile("\n".join(lines), "README.md", "exec"), names)
        ran += 1
    assert ran >= 3 and (tmp_path / "ball.ply").stat().st_size > 10000
    assert [len(mesh.faces) > 0 for mesh in names["meshes"]] == [True] * 3


def prepare(folder):
    """Inputs of the examples, under their names; plots are not shown."""
    import meshio
    import pyvista
    import zarr
    pyvista.PolyData.plot = lambda self: None
    random = np.random.default_rng(1)
    cube = np.array([[x, y, z] for z in (0, 1) for y, x in ((0, 0), (0, 1), (1, 1), (1, 0))], float)
    meshio.Mesh(cube, [("hexahedron", [range(8)])], {"temperature": np.arange(8) * 100.0}).write(folder / "engine.vtu")
    if not (folder / "scan.zarr").exists():
        zarr.save_array(folder / "scan.zarr", random.integers(0, 255, (9, 9, 9)).astype("u1"))
    data = os.environ.get("TETRACUBES_DATA")
    exodus = folder / "disk_out_ref.ex2"
    if data is None:
        pytest.skip("TETRACUBES_DATA is not set")
    if not exodus.exists():
        exodus.symlink_to(Path(data) / "unstructured" / exodus.name)


def test_arguments():
    """The table names every argument but level and axes, which the text has."""
    table = re.search(r"\| argument \|.*?\n\n", PAGE, re.DOTALL).group()
    named = set(re.findall(r"`(\w+)`", re.sub(r"\|[^|]*\|$", "", table, flags=re.MULTILINE)))
    assert named == set(inspect.signature(tetracubes.isosurface).parameters) - {"volume", "level", "axes"}


@pytest.mark.parametrize("name", tetracubes.__all__)
def test_docstrings(name):
    """Everything public is described and typed."""
    one = getattr(tetracubes, name)
    assert one.__doc__
    members = [(name, one)] if inspect.isfunction(one) else [
        (f"{name}.{key}", getattr(value, "fget", None) or getattr(value, "__func__", value))
        for key, value in vars(one).items() if not key.startswith("_")] if inspect.isclass(one) else []
    for key, member in members:
        if inspect.isfunction(member):
            assert member.__doc__, key
            hints = inspect.signature(member)
            assert hints.return_annotation is not inspect.Signature.empty, key
            for parameter in hints.parameters.values():
                assert parameter.name in ("self", "cls") or parameter.annotation is not inspect.Parameter.empty, key
