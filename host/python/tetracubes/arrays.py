"""Arrays of any kind become what the library takes: native, contiguous, x fastest. Copied only where they are not."""
from __future__ import annotations

from typing import Any

import numpy as np

from .library import tc_type

#: Types of samples that the library knows.
TYPES = {np.dtype(name): kind for name, kind in zip(("u1", "i1", "u2", "i2", "u4", "i4", "f4", "f8"), tc_type)}

_CPU = 1  # of DLPack


def _as_numpy(array, what):
    """The array as numpy sees it: through DLPack where it offers that, else by __array_interface__ or the buffer."""
    if isinstance(array, np.ndarray):
        return array
    if hasattr(array, "__dlpack_device__"):
        if array.__dlpack_device__()[0] != _CPU:
            raise ValueError(f"{what} lies on a device: copy it to the host, or hand its OpenCL buffer to "
                             "Grid.from_opencl")
        try:
            return np.from_dlpack(array)
        except (TypeError, RuntimeError, BufferError) as error:
            raise ValueError(f"{what} cannot be taken through DLPack: {error}") from error
    try:
        return np.asanyarray(array)
    except (TypeError, ValueError) as error:
        raise ValueError(f"{what} is no array: {error}") from error


def _known(array, what):
    """Types that the library does not know become one that holds the same values."""
    if array.dtype.newbyteorder("=") in TYPES:
        return array
    if array.dtype == np.bool_:
        return array.view(np.uint8)
    if array.dtype.kind == "f" and array.dtype.itemsize == 2:
        return array.astype(np.float32)
    if array.dtype.kind in "iu":
        low, high = (int(array.min()), int(array.max())) if array.size else (0, 0)
        for kind in (np.int32, np.uint32):
            if np.iinfo(kind).min <= low and high <= np.iinfo(kind).max:
                return array.astype(kind)
        raise ValueError(f"{what} has integers of {low} to {high}, beyond 32 bits: convert it with astype(numpy.float64)")
    raise ValueError(f"{what} has values of type {array.dtype}: integers, float16, float32 and float64 can be contoured")


def values_of(array: Any, what: str) -> np.ndarray:
    """As a contiguous array of one of TYPES."""
    array = _known(_as_numpy(array, what), what)
    return np.require(array, array.dtype.newbyteorder("="), ["C", "A"])


def volume_of(volume: Any, mask: Any, what: str = "volume") -> tuple[np.ndarray, np.ndarray | None]:
    """Samples (z, y, x), and what is missing of them: 1 in a u8 array of the same shape, or None.

    Samples are missing where a masked array is masked, and where mask is false.
    """
    volume = _as_numpy(volume, what)
    if volume.ndim != 3:
        raise ValueError(f"{what} has {volume.ndim} dimensions, not 3: z, y, x")
    missing = np.ma.getmaskarray(volume) if np.ma.is_masked(volume) else None
    if mask is not None:
        mask = _as_numpy(mask, "mask")
        if mask.shape != volume.shape:
            raise ValueError(f"mask has the shape {mask.shape}, and {what} {volume.shape}")
        absent = (mask == 0) | (mask != mask)  # as of the tool: 0, or NaN
        missing = absent if missing is None else missing | absent
    samples = values_of(np.ma.getdata(volume), what)
    return samples, None if missing is None else np.ascontiguousarray(missing).view(np.uint8)


def type_of(dtype):
    """The library's number of a type of samples in native byte order."""
    dtype = np.dtype(dtype)
    if dtype not in TYPES:
        raise ValueError(f"dtype is {dtype}, not one of {', '.join(str(known) for known in TYPES)}")
    return TYPES[dtype]


def address(array):
    """Where the array's values lie; None for None."""
    return None if array is None else array.ctypes.data


def vector(numbers, what):
    """Three finite numbers; one number stands for three."""
    try:
        made = np.broadcast_to(np.asarray(numbers, np.float64), 3)
    except (TypeError, ValueError) as error:
        raise ValueError(f"{what} is {numbers!r}, not three numbers") from error
    return made


def matrix(spacing, origin, direction, axes):
    """Index space to world as the library has it, 3 x 4, x first."""
    spacing, origin = vector(spacing, "spacing"), vector(origin, "origin")
    direction = np.eye(3) if direction is None else np.asarray(direction, np.float64)
    if direction.shape != (3, 3):
        raise ValueError(f"direction has the shape {direction.shape}, not (3, 3)")
    made = np.column_stack([direction * spacing, origin])
    return made if axes == "xyz" else made[::-1, [2, 1, 0, 3]]


class _Memory:
    """Memory of the library's that numpy reads in place; the owner lives as long as arrays of it."""

    def __init__(self, address, shape, dtype, owner):
        self.__array_interface__ = {"data": (address, False), "shape": shape, "typestr": np.dtype(dtype).str,
                                    "version": 3}
        self.owner = owner


def owned(address, shape, dtype, owner):
    """An array over memory of the owner's, without a copy; address None: an empty one."""
    return np.asarray(_Memory(address, shape, dtype, owner)) if address else np.empty(shape, dtype)
