"""second_opencl.py - another implementation of OpenCL for CPUs, from the Python package index, in a folder of its own

Intel's runtime, which shares neither compiler nor scheduler with PoCL. Nothing is installed: packages are downloaded by
pip and unpacked, and the library's path, which OCL_ICD_VENDORS takes, is printed. What is there already is used again.

Usage: second_opencl.py FOLDER; exit status 77 where it cannot be had, with the reason
"""
import glob
import os
import shutil
import subprocess
import sys
import tempfile
import zipfile

PACKAGES = ["intel-opencl-rt", "intel-cmplr-lib-rt"]


def give_up(reason):
    print(f"skipped: no second implementation of OpenCL: {reason}")
    sys.exit(77)


def wheels_get(folder):
    """They and what they need; about 300 MB."""
    if subprocess.run([sys.executable, "-m", "pip", "--version"], stdout=subprocess.DEVNULL,
                      stderr=subprocess.DEVNULL).returncode:
        give_up("pip is not installed (Debian: apt install python3-pip)")
    done = subprocess.run([sys.executable, "-m", "pip", "download", "--quiet", "--disable-pip-version-check",
                           "--only-binary=:all:", "--dest", folder] + PACKAGES, stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT, text=True)
    if done.returncode:
        give_up(f"pip cannot download {' and '.join(PACKAGES)}:\n{done.stdout[-500:]}")


def libraries_unpack(wheels, folder):
    """Files of data/lib, all into one folder, where they find each other; a loader of OpenCL is here already,
    and nothing is linked."""
    for wheel in glob.glob(os.path.join(wheels, "*.whl")):
        with zipfile.ZipFile(wheel) as archive:
            for name in archive.namelist():
                base = os.path.basename(name)
                if ".data/data/lib/" in name and base and not base.startswith(("libOpenCL", "icx-lto")):
                    with archive.open(name) as source, open(os.path.join(folder, base), "wb") as out:
                        shutil.copyfileobj(source, out)


def main():
    folder = os.path.abspath(sys.argv[1])
    library = os.path.join(folder, "libintelocl.so")
    if not os.path.exists(library):
        os.makedirs(folder, exist_ok=True)
        with tempfile.TemporaryDirectory(dir=folder) as wheels:
            wheels_get(wheels)
            libraries_unpack(wheels, folder)
    if not os.path.exists(library):
        give_up(f"{' and '.join(PACKAGES)} have no libintelocl.so")
    print(library)


main()
