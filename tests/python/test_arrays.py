"""Arrays of every kind give the mesh of the plain one, and are copied only where they have to be."""
import numpy as np
import pytest
from tetracubes import arrays


def fortran(volume):
    return np.asfortranarray(volume)


def strided(volume):
    return np.repeat(volume, 2, axis=2)[:, :, ::2]


def reversed_(volume):
    return np.ascontiguousarray(volume[::-1, :, ::-1])[::-1, :, ::-1]


def big_endian(volume):
    return volume.astype(volume.dtype.newbyteorder(">"))


def read_only(volume):
    volume = volume.copy()
    volume.flags.writeable = False
    return volume


def misaligned(volume):
    room = np.empty(volume.nbytes + 1, np.uint8)
    made = room[1:].view(volume.dtype).reshape(volume.shape)
    made[...] = volume
    return made


class Interface:
    """What has __array_interface__ and nothing else."""

    def __init__(self, volume):
        self.volume, self.__array_interface__ = volume, volume.__array_interface__


class DLPack:
    """What has DLPack and nothing else."""

    def __init__(self, volume, device=1):
        self.volume, self.device = volume, device

    def __dlpack__(self, **options):
        return self.volume.__dlpack__(**options)

    def __dlpack_device__(self):
        return self.device, 0


@pytest.mark.parametrize("make", [fortran, strided, reversed_, big_endian, read_only, misaligned, Interface,
                                   DLPack, memoryview])
def test_same_mesh(ball, surface, make):
    assert surface(make(ball)).hash == surface().hash


@pytest.mark.parametrize("make", [read_only, Interface, DLPack, memoryview])
def test_not_copied(ball, make):
    volume = make(ball)
    samples, missing = arrays.volume_of(volume, None)
    given = volume if isinstance(volume, np.ndarray) else ball
    assert np.shares_memory(samples, given) and missing is None


@pytest.mark.parametrize("dtype", ["?", "f2", "i8", "u8", ">u2", ">i4"])
def test_types_that_are_converted(ball, surface, dtype):
    volume = (ball > 0) if dtype == "?" else np.clip(ball + 20, 0, 100).astype(dtype)
    level = 0.5 if dtype == "?" else 20.25
    assert surface(volume, level).hash == surface(volume.astype("u1" if dtype == "?" else "f4"), level).hash


def test_lists(ball, surface):
    assert surface(ball.tolist()).hash == surface(ball.astype("f8")).hash


def test_large_unsigned(ball, surface):
    volume = np.where(ball > 0, np.uint64((1 << 32) - 1), np.uint64(0))
    assert surface(volume, 1 << 31).hash == surface(volume.astype("u4"), 1 << 31).hash


def test_on_a_device(ball, surface):
    with pytest.raises(ValueError, match="lies on a device: copy it to the host"):
        surface(DLPack(ball, device=2))


def test_inputs_are_not_changed(ball, surface):
    before = ball.copy()
    surface(normals=True, nodata=3, mask=ball < 5)
    np.testing.assert_array_equal(ball, before)
