"""Pictures of meshes: the tool's pixels, as an array, as a file, in a notebook; what cannot be drawn is refused."""
import zlib

import numpy as np
import pytest
from tetracubes.mesh import Mesh


def pixels_of(path):
    """The pixels of an RGB file as numpy sees them: rows are unfiltered here, by the PNG specification."""
    content, at, data = path.read_bytes(), 8, b""
    while at < len(content):
        size, kind = int.from_bytes(content[at:at + 4], "big"), content[at + 4:at + 8]
        if kind == b"IHDR":
            width, height = (int.from_bytes(content[n:n + 4], "big") for n in (at + 8, at + 12))
        if kind == b"IDAT":
            data += content[at + 8:at + 8 + size]
        at += 12 + size
    rows = np.frombuffer(zlib.decompress(data), np.uint8).reshape(height, 3 * width + 1)
    above, image = [0] * (3 * width), []
    for kind, *line in rows.tolist():
        for n in range(3 * width):
            a, b, c = (line[n - 3], above[n], above[n - 3]) if n > 2 else (0, above[n], 0)
            nearest = min((abs(b - c), 0, a), (abs(a - c), 1, b), (abs(a + b - 2 * c), 2, c))[2]
            line[n] = line[n] + (0, a, b, (a + b) // 2, nearest)[kind] & 255
        above = line
        image.append(line)
    return np.array(image, np.uint8).reshape(height, width, 3)


@pytest.fixture
def has_png(surface):
    if surface()._repr_png_() is None:
        pytest.skip("built without libpng")


def test_is_the_tools(ball, tool, surface, tmp_path, has_png):
    """The same pixels from the mesh, from its file, and from the tool."""
    mesh = surface()
    mesh.preview(tmp_path / "own.png", view=(30, 20), size=(80, 60))
    tool(ball, "--iso", "0", "--preview", "tool.png", "--view", "30,20", "--preview-size", "80,60")
    wanted = mesh.picture((30, 20), (80, 60))
    np.testing.assert_array_equal(pixels_of(tmp_path / "own.png"), wanted)
    assert (tmp_path / "tool.png").read_bytes() == (tmp_path / "own.png").read_bytes()


def test_disc(surface):
    """A ball is a disc of known size, blue; turned over, ochre; stretched, an ellipse."""
    picture = surface().picture("front", (100, 100))
    is_seen = (picture != 255).any(axis=2)
    assert is_seen.sum() == pytest.approx(np.pi * 46 ** 2, rel=0.02)
    assert (picture[is_seen][:, 2] > picture[is_seen][:, 0]).all()
    mesh = surface()
    turned = Mesh(mesh.positions, mesh.triangles[:, ::-1], None, {}, mesh.origin, "zyx", 0).picture("front", (100, 100))
    assert (turned[50, 50, 2] < turned[50, 50, 0]) and ((turned != 255).any(axis=2) == is_seen).all()
    high = (surface(spacing=(2, 1, 1)).picture("front", (100, 100)) != 255).any(axis=2)
    assert high.any(axis=1).sum() == pytest.approx(2 * high.any(axis=0).sum(), abs=3)


def test_far(surface):
    """Where the mesh lies does not show."""
    near, far = surface().picture(size=(100, 80)), surface(origin=(1e7, 0, -3e6)).picture(size=(100, 80))
    assert (near != far).any(axis=2).sum() < 30


def test_files(surface, tmp_path, has_png):
    mesh = surface()
    mesh.save(tmp_path / "a.PNG")
    assert mesh._repr_png_()[:8] == b"\x89PNG\r\n\x1a\n" == (tmp_path / "a.PNG").read_bytes()[:8]
    with pytest.raises(OSError, match="create the folder"):
        mesh.save(tmp_path / "nowhere" / "a.png")
    with pytest.raises(ValueError, match="let the name end in .png"):
        mesh.preview(tmp_path / "a.jpg")
    assert [path.name for path in tmp_path.iterdir()] == ["a.PNG"]


@pytest.mark.parametrize("options", [{"view": "up"}, {"view": (1, 2, 3)}, {"view": (0, 91)}, {"view": (float("nan"), 0)},
                                     {"view": 3}, {"size": (15, 100)}, {"size": (100, 8193)}])
def test_refused(surface, options):
    with pytest.raises(ValueError, match=next(iter(options))):
        surface().picture(**options)


def test_empty(surface):
    assert (surface(level=1e6).picture(size=(20, 20)) == 255).all()


def test_order_of_memory(surface):
    """Arrays that are not contiguous are drawn as they are."""
    mesh = surface()
    padded = np.zeros((len(mesh.positions), 4), np.float32)
    padded[:, 1:] = mesh.positions
    other = Mesh(padded[:, 1:], np.asfortranarray(mesh.triangles), None, {}, mesh.origin, "zyx", 0)
    np.testing.assert_array_equal(other.picture(size=(40, 30)), mesh.picture(size=(40, 30)))
