"""Unstructured grids, as meshio and PyVista have them."""
import numpy as np
import pytest
import tetracubes
from conftest import signed_volume

SIZE = 9


def cubes():
    """Points of a cube of SIZE^3 samples around 0, and its hexahedra in VTK's order."""
    z, y, x = np.mgrid[:SIZE, :SIZE, :SIZE]
    points = np.stack([x.ravel(), y.ravel(), z.ravel()], axis=1) - (SIZE - 1) / 2.0
    first = np.arange(SIZE ** 3).reshape(SIZE, SIZE, SIZE)[:-1, :-1, :-1].ravel()
    corners = [0, 1, SIZE + 1, SIZE]
    return points, first[:, None] + np.array(corners + [SIZE * SIZE + corner for corner in corners])


POINTS, CELLS = cubes()
VALUES = 3 - np.linalg.norm(POINTS, axis=1)


def contour(cells, points=POINTS, values=VALUES, level=0.1, **options):
    return tetracubes.contour_cells(points, cells, values, level, engine="reference", **options)


class Block:
    """meshio.CellBlock."""

    type, data = "hexahedron", CELLS


VTK = np.full(len(CELLS), 12, np.uint8), np.arange(0, 8 * len(CELLS) + 1, 8), CELLS.ravel()


@pytest.mark.parametrize("cells", [[Block()], [("hexahedron", CELLS)], {"hexahedron": CELLS.astype(np.uint32)}, VTK,
                                   [("vertex", [[0]]), ("hexahedron", CELLS), ("quad", CELLS[:, :4])]])
def test_same_mesh(cells):
    mesh = contour(cells, carry={"x": POINTS[:, 0], "points": POINTS})
    assert mesh.hash == contour([("hexahedron", CELLS)]).hash
    assert signed_volume(mesh.vertices, mesh.faces) == pytest.approx(4 / 3 * np.pi * 2.9 ** 3, rel=0.1)
    np.testing.assert_allclose(mesh.values["points"], mesh.vertices, atol=1e-5)
    np.testing.assert_allclose(mesh.values["x"], mesh.vertices[:, 0], atol=1e-5)


def test_hybrid():
    mesh, tetra = contour(VTK, method="hybrid"), contour(VTK)
    assert len(mesh.faces) < len(tetra.faces) / 2
    assert signed_volume(mesh.vertices, mesh.faces) == pytest.approx(signed_volume(tetra.vertices, tetra.faces), rel=0.02)
    assert tetracubes.contour_cells(POINTS, VTK, VALUES, 0.1, method="hybrid").hash == mesh.hash


def test_closed():
    for method in "tetra", "hybrid":
        mesh = contour(VTK, level=-1000, method=method, closed=True)
        assert signed_volume(mesh.vertices, mesh.faces) == pytest.approx((SIZE - 1) ** 3)
        half = contour(VTK, values=POINTS[:, 0], level=0.5, method=method, closed=True, carry={"points": POINTS})
        assert signed_volume(half.vertices, half.faces) == pytest.approx((SIZE - 1) ** 2 * (SIZE / 2 - 1))
        np.testing.assert_allclose(half.values["points"], half.vertices, atol=1e-5)
        assert tetracubes.contour_cells(POINTS, VTK, VALUES, -1.5, method=method, closed=True).hash == contour(
            VTK, level=-1.5, method=method, closed=True).hash


def test_float32_points():
    assert contour(VTK, points=POINTS.astype("f4")).hash == contour(VTK).hash
    assert contour(VTK, points=POINTS.astype(">f4")[::-1][::-1]).hash == contour(VTK).hash


def test_tool_makes_the_same(tmp_path):
    """The grid as a VTK legacy file, through the tool."""
    import json
    import subprocess
    import sys
    lines = ["# vtk DataFile Version 3.0", "cubes", "ASCII", "DATASET UNSTRUCTURED_GRID",
             f"POINTS {len(POINTS)} double", *(" ".join(map(repr, map(float, point))) for point in POINTS),
             f"CELLS {len(CELLS)} {9 * len(CELLS)}", *("8 " + " ".join(map(str, cell)) for cell in CELLS),
             f"CELL_TYPES {len(CELLS)}", *["12"] * len(CELLS), f"POINT_DATA {len(POINTS)}", "SCALARS f double",
             "LOOKUP_TABLE default", *map(repr, map(float, VALUES))]
    (tmp_path / "cubes.vtk").write_text("\n".join(lines) + "\n")
    done = subprocess.run([sys.executable, "-m", "tetracubes", "extract", tmp_path / "cubes.vtk", "--iso", "0.1",
                           "--engine", "reference", "--json"], stdout=subprocess.PIPE, check=True)
    assert json.loads(done.stdout)["surfaces"][0]["hash"] == contour(VTK).hash


@pytest.mark.parametrize("options, text", [
    ({"points": POINTS[:, :2]}, r"not \(n, 3\)"), ({"values": VALUES[1:]}, "one value each"),
    ({"cells": [("brick", CELLS)]}, "'brick' are not known"), ({"cells": [("hexahedron", CELLS + 1)]}, "point"),
    ({"cells": (VTK[0], VTK[1] + 1, VTK[2])}, "rise from 0"), ({"cells": (VTK[0], VTK[1][1:], VTK[2])}, "shapes"),
    ({"cells": (VTK[0], np.concatenate([[0, 16, 8], VTK[1][3:]]), VTK[2])}, "rise from 0"),
    ({"cells": [("hexahedron", CELLS + 0.5)]}, "float64, not integers"),
    ({"cells": (VTK[0].astype(int) + 256, *VTK[1:])}, "go from 268 to 268: they do not fit uint8"),
    ({"cells": (VTK[0], VTK[1] * 1.0, VTK[2])}, "offsets of cells are of type float64"),
    ({"cells": (VTK[0] * 0 + 42, *VTK[1:])}, "(?i)polyhedr"), ({"cells": [("hexahedron", CELLS[0])]}, "dimensions"),
    ({"points": POINTS * np.nan}, "finite"), ({"level": np.inf}, "isovalue"),
])
def test_bad_input(options, text):
    with pytest.raises(ValueError, match=text):
        contour(**{"cells": VTK, **options})


def test_unsupported_cells_can_be_left_out():
    types = VTK[0].copy()
    types[:5] = 60  # Lagrange
    with pytest.raises(ValueError, match="60"):
        contour((types, *VTK[1:]))
    assert len(contour((types, *VTK[1:]), skip_unsupported=True).faces)
