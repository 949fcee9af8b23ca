"""Isosurfaces of volumes and unstructured grids by marching tetrahedra, on OpenCL devices or without.

    import tetracubes
    mesh = tetracubes.isosurface(volume, 127.5)  # a numpy array, axes z, y, x
    mesh.save("surface.ply")

Every device gives the same mesh, byte for byte. ``python -m tetracubes`` is the command-line tool.
"""
from . import compat
from .cells import contour_cells
from .context import Device, devices
from .grid import Counts, DeviceMesh, Grid, isosurface, isovolume, labels
from .library import DeviceError, tc
from .mesh import Mesh
from .parts import isosurface_by_parts
from .tetrahedra import Tetrahedra

__version__ = tc.tc_version().decode()
__all__ = ["Counts", "Device", "DeviceError", "DeviceMesh", "Grid", "Mesh", "Tetrahedra", "compat",
           "contour_cells", "devices", "isosurface", "isosurface_by_parts", "isovolume", "labels"]
