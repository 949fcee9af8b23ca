#!/usr/bin/env python3
"""The wheel, in an environment of its own beside the packages that people use it with, from PyPI.

    packages.py SOURCE FOLDER TOOL

Builds the wheel by host/python/manylinux, installs it, runs all tests of tests/python on it and those of files that VTK
writes and reads, and measures what a call costs beside the same calls of the C library. Its tool makes the same mesh and
picture in Debian 11, whose C library it was linked with. Then, where root can make one, a fresh chroot of the release
after this one: there it makes the same mesh and picture, without OpenCL and with PoCL. 77 without PyPI.
"""
import json
import os
import shutil
import subprocess
import sys
import time
from pathlib import Path

TESTS = Path(__file__).resolve().parent.parent
sys.path[:0] = [str(TESTS / "common"), str(TESTS / "systems")]
import systems  # noqa: E402
from part import part_write  # noqa: E402

MOST_BYTES = 3_000_000
MOST_RATIO = 1.1
PACKAGES = ["numpy", "pytest", "pyopencl", "pyvista", "trimesh", "meshio", "netCDF4", "h5py", "dask", "zarr",
            "scikit-image", "tqdm"]
TAG = "manylinux_2_28_x86_64"


def run(*command, **options):
    return subprocess.run([str(word) for word in command], check=True, **options)


def environment(folder, packages):
    """A virtual environment with packages: its folder of programs. None where PyPI cannot be reached."""
    run(sys.executable, "-m", "venv", "--clear", folder)
    done = subprocess.run([folder / "bin" / "pip", "install", "-q", *packages], check=False)
    return folder / "bin" if done.returncode == 0 else None


def tried_in_old(made, folder, tool):
    """Whether the wheel's tool makes the same files in the sysroot that it was linked with, none of it newer."""
    root = folder / "wheel" / "sysroot"
    run(sys.executable, "-m", "zipfile", "-e", made, root / "wheel")
    (root / "wheel" / "tetracubes" / "tetracubes").chmod(0o755)
    command = ("TOOL generate gyroid --dims 64,64,64 --type u8 -o g.nrrd --quiet && TOOL extract g.nrrd --iso 127.5 "
               "--engine reference --quiet -o mesh.ply --preview mesh.png")
    run("sh", "-c", command.replace("TOOL", str(tool)), cwd=folder)
    systems.within(str(root), "cd /wheel && " + command.replace("TOOL", "./tetracubes/tetracubes"), folder / "old.log")
    return all((folder / name).read_bytes() == (root / "wheel" / name).read_bytes() for name in ("mesh.ply", "mesh.png"))


SUITE = "trixie"
TRIAL = """import hashlib, numpy, tetracubes
z, y, x = numpy.mgrid[-1:1:64j, -1:1:64j, -1:1:64j]
mesh = tetracubes.isosurface(1 - numpy.sqrt(x**2 + y**2 + z**2), 0.3)
mesh.save("ball.png")
print(mesh.hash, hashlib.sha256(mesh.picture()).hexdigest(), len(tetracubes.devices()))
"""


def told(python, folder):
    """What the trial prints: hashes of mesh and pixels, devices."""
    return run(python, "-c", TRIAL, stdout=subprocess.PIPE, text=True, cwd=folder).stdout.split()


def tried_elsewhere(made, folder):
    """The same from a fresh chroot, before and behind PoCL's installation; none where it cannot be made."""
    if os.geteuid() != 0 or not shutil.which("debootstrap"):
        print("no chroot: the wheel is tried on this release alone")
        return []
    chroot, log = folder / SUITE, folder / f"{SUITE}.log"
    try:
        systems.chroot_make(SUITE, str(chroot), log)
    except systems.Failed as failed:
        print(f"no chroot: {failed}")
        return []
    home = chroot / "root"
    shutil.copy(made, home)
    (home / "trial.py").write_text(TRIAL, encoding="utf-8")
    systems.within(str(chroot), "apt-get install -y --no-install-recommends python3-venv python3-numpy && cd /root && "
                   "python3 -m venv --system-site-packages v && v/bin/pip install --no-index --no-deps *.whl && "
                   "v/bin/python trial.py > without && "
                   "apt-get install -y --no-install-recommends ocl-icd-libopencl1 pocl-opencl-icd && "
                   "v/bin/python trial.py > with", log)
    lines = [(home / name).read_text(encoding="utf-8").split() for name in ("without", "with")]
    shutil.rmtree(chroot, ignore_errors=True)
    return lines


def main():
    source, folder = Path(sys.argv[1]).resolve(), Path(sys.argv[2])
    begin = time.monotonic()
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    folder = folder.resolve()
    python = environment(folder / "packages", PACKAGES)
    if not python:
        print("skipped: packages cannot be had from PyPI")
        return 77
    run("bash", source / "host" / "python" / "manylinux", folder / "wheel")
    made = next((folder / "wheel").glob("*.whl"))
    size, tag = made.stat().st_size, made.stem.split("-")[-1]
    run(python / "pip", "install", "-q", made)
    clean = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
    here = Path(__file__).resolve().parent
    run(python / "python", "-m", "pytest", "-q", "-p", "no:cacheprovider", here, env={**clean, "TEST_PACKAGES": "1"})
    tool = next((folder / "packages").glob("lib/*/site-packages/tetracubes/tetracubes"))
    for one in (tool, sys.argv[3]):  # by the VTK of pyvista; TOOL may have HDF5
        run(python / "python", here.parent / "tool" / "test_pieces_vtk.py", one, "reference", env=clean)
    ratios = json.loads(run(python / "python", here / "round_trip.py", env=clean, stdout=subprocess.PIPE, text=True).stdout)
    print(f"{made.name}: {size} bytes; time by that of the C calls: {ratios}")
    wanted, elsewhere = told(python / "python", folder), tried_elsewhere(made, folder)
    same_in_old = tried_in_old(made, folder, tool)
    print(f"here {wanted}, on {SUITE} {elsewhere}; in Debian 11 the same files: {same_in_old}")
    others = [("hashes there as here, without OpenCL and with it, on Debian 13",
               sum(line[:2] == wanted[:2] for line in elsewhere))] if elsewhere else []
    listed = json.loads(run(python / "pip", "list", "--format", "json", stdout=subprocess.PIPE, text=True).stdout)
    known = {one["name"]: one["version"] for one in listed}
    part_write("python", {name: known[name] for name in PACKAGES if name in known},
               [("bytes of the wheel", size), ("systems that it is for", tag)]
               + [(f"time of a call beside the C library's, {name}", ratio) for name, ratio in ratios.items()] + others,
               time.monotonic() - begin)
    is_same = all(line[:2] == wanted[:2] for line in elsewhere) and [line[2] for line in elsewhere] in ([], ["0", "1"])
    return 0 if is_same and same_in_old and tag == TAG and size <= MOST_BYTES and max(ratios.values()) <= MOST_RATIO else 1


if __name__ == "__main__":
    sys.exit(main())
