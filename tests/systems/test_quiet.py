#!/usr/bin/env python3
"""test_quiet.py TOOL [PLAIN_PROCESSOR] - users see nothing of what a driver's compiler does

Kernels are built anew, in empty caches; the tool, told to be quiet, has to be. PLAIN_PROCESSOR, a library to preload:
once more for a processor without AVX-512, for which the text is another one and vectors are longer than registers.
Where there is no PoCL, another driver may say what it likes: status 77.
"""
import os
import subprocess
import sys
import tempfile


def quiet_check(tool, folder, name, settings):
    volume = os.path.join(folder, "a.nrrd")
    subprocess.run([tool, "generate", "sphere", "--dims", "20,20,20", "--type", "u8", "-o", volume, "--quiet"],
                   check=True)
    caches = {}
    for cache in ("POCL_CACHE_DIR", "TETRACUBES_CACHE_DIR"):
        caches[cache] = os.path.join(folder, f"{name}_{cache}")
        os.mkdir(caches[cache])
    done = subprocess.run([tool, "extract", volume, "--iso", "127.5", "--device", "portable", "--quiet"],
                          env=dict(os.environ, **caches, **settings), stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                          text=True, check=False)
    if done.returncode or done.stdout:
        sys.exit(f"{name}: status {done.returncode}, and it says:\n{done.stdout}")
    print(f"{name}: nothing is said")


def main():
    tool, preloaded = sys.argv[1], sys.argv[2:]
    listed = subprocess.run([tool, "devices"], stdout=subprocess.PIPE, text=True, check=False)
    if "Portable Computing Language" not in listed.stdout:
        print("skipped: no PoCL")
        sys.exit(77)
    with tempfile.TemporaryDirectory() as folder:
        quiet_check(tool, folder, "this processor", {})
        for library in preloaded:
            quiet_check(tool, folder, "without AVX-512", {"LD_PRELOAD": library})


main()
