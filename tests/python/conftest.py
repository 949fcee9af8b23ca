"""What the tests of the Python package share. PYTHONPATH leads to the package of the build."""
import json
import subprocess
import sys

import numpy as np
import pytest
import tetracubes


@pytest.fixture
def ball():
    """float32 (z, y, x), all three sizes different; its level 0 is a sphere of radius 9 around (12, 14, 16)."""
    z, y, x = np.mgrid[:25, :29, :33]
    return (9 - np.sqrt((z - 12.0) ** 2 + (y - 14.0) ** 2 + (x - 16.0) ** 2)).astype(np.float32)


@pytest.fixture
def surface(ball):
    """contour(volume, level, ...) by the reference engine, which needs no OpenCL; level 0 of the ball by default."""
    def contour(volume=ball, level=0.0, **options):
        return tetracubes.isosurface(volume, level, engine="reference", **options)
    return contour


@pytest.fixture
def tool(tmp_path):
    """tool(volume, *arguments): the report of python -m tetracubes extract on the volume's bytes."""
    def extract(volume, *arguments):
        kind = {"f": "f", "i": "i", "u": "u"}[volume.dtype.kind] + str(8 * volume.dtype.itemsize)
        volume.tofile(tmp_path / "volume.raw")
        done = subprocess.run([sys.executable, "-m", "tetracubes", "extract", "volume.raw", "--type", kind, "--dims",
                               ",".join(map(str, volume.shape[::-1])), "--engine", "reference", "--json", *arguments],
                              cwd=tmp_path, stdout=subprocess.PIPE, check=True)
        return json.loads(done.stdout)
    return extract


def signed_volume(vertices, faces):
    """Positive where faces wind counter-clockwise seen from outside."""
    a, b, c = (vertices[faces[:, corner]].astype(np.float64) for corner in range(3))
    return np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6
