"""bytes.py - one hash per case over implementations of OpenCL, numbers of threads and all that test_bytes varies

Each run of test_bytes compares the device with the reference; here the hashes of all runs are compared, too.
Implementations: the one installed, and Intel's runtime from the Python package index (second_opencl.py); where that
cannot be had it is told, the exit status is 77, and there are no figures. A third, Oclgrind, compares small grids in
oclgrind.py.

Usage: bytes.py TEST_BYTES FOLDER, FOLDER for the second implementation and caches
With TETRACUBES_RESULTS in the environment, a folder, the figures go to bytes.json in it.
"""
import os
import re
import subprocess
import sys
import time

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "common"))
from part import part_write

HERE = os.path.dirname(os.path.abspath(__file__))


def threads(n):
    """For PoCL before and since version 4, and for Intel's runtime."""
    return {"POCL_MAX_PTHREAD_COUNT": n, "POCL_CPU_MAX_CU_COUNT": n, "DPCPP_CPU_NUM_CUS": n}


def second_find(folder):
    done = subprocess.run([sys.executable, os.path.join(HERE, "second_opencl.py"), folder], stdout=subprocess.PIPE,
                          text=True)
    if done.returncode not in (0, 77):
        sys.exit("second_opencl.py fails")
    if done.returncode:
        print(done.stdout.strip())
    return None if done.returncode else done.stdout.strip()


def runs_list(folder):
    """Name, tier and environment of every run."""
    runs = [(f"installed, {n} thread(s)", "whole", threads(n)) for n in ("1", "2", "16")]
    runs.append(("installed, small grids", "small", {}))
    for missing, flags in (("AVX-512", "-DNO_AVX512"), ("AVX2", "-DNO_AVX512 -DNO_AVX2")):
        runs.append((f"installed, for processors without {missing}", "sample",
                     {"POCL_EXTRA_BUILD_FLAGS": flags, "TETRACUBES_CACHE_DIR": ""}))
    second = second_find(os.path.join(folder, "second"))
    if second:
        own = {"OCL_ICD_VENDORS": second, "TETRACUBES_CACHE_DIR": os.path.join(folder, "cache")}
        os.makedirs(own["TETRACUBES_CACHE_DIR"], exist_ok=True)
        runs += [(f"second, {n} thread(s)", "whole", dict(own, **threads(n))) for n in ("1", "2", "16")]
        scalar = {"OCL_ICD_VENDORS": second, "CL_CONFIG_USE_VECTORIZER": "False"}
        runs.append(("second, not vectorised", "sample", scalar))
    return runs


def run(program, name, tier, settings):
    """Hashes by case, and what else it says of itself."""
    start = time.time()
    done = subprocess.run([program, tier], env=dict(os.environ, **settings), stdout=subprocess.PIPE, text=True)
    if done.returncode:
        sys.exit(f"{name}: status {done.returncode}\n{done.stdout}")
    hashes = dict(re.findall(r"^case (.*): ([0-9a-f]{16})$", done.stdout, re.M))
    platform, driver = re.search(r"^device ([^,]*), .*driver (.*)$", done.stdout, re.M).groups()
    cases, variants, meshes, slabs = map(int, re.search(r"^figures (\d+) cases, (\d+) variants, (\d+) meshes, (\d+)",
                                                        done.stdout, re.M).groups())
    print(f"{name}: {platform} {driver}: {cases} cases, {variants} variants, {meshes} meshes, {slabs} in slabs, "
          f"{time.time() - start:.0f} s", flush=True)
    return {"run": name, "tier": tier, "platform": platform, "driver": driver, "cases": cases, "variants": variants,
            "meshes": meshes, "slab_meshes": slabs, "hashes": hashes}


def differences(done):
    """Cases whose hash is not the same in all runs on grids of one size."""
    found, known = [], {}
    for one in done:
        for case, value in one["hashes"].items():
            name, wanted = known.setdefault((one["tier"] == "small", case), (one["run"], value))
            if value != wanted:
                found.append(f"{case}: {value} by {one['run']}, {wanted} by {name}")
    return found


def results_write(done, seconds):
    whole = [one for one in done if one["tier"] == "whole"]
    versions = {one["platform"]: one["driver"] for one in done}
    figures = [("cases of grids, one hash each", max(one["cases"] for one in whole)),
               ("variants of launching each", max(one["variants"] for one in whole)),
               ("implementations of OpenCL with the same bytes", len(versions)),
               ("meshes with the reference's hash", sum(one["meshes"] for one in done)),
               ("of these made in slabs", sum(one["slab_meshes"] for one in done))]
    part_write("bytes", versions, figures, seconds, hashes=whole[0]["hashes"],
               runs=[{key: one[key] for key in one if key != "hashes"} for one in done])


def main():
    program, folder = sys.argv[1:]
    start = time.time()
    done = [run(program, *one) for one in runs_list(os.path.abspath(folder))]
    found = differences(done)
    if found:
        sys.exit("\n".join(found))
    platforms = sorted({one["platform"] for one in done})
    print(f"one hash per case over {len(done)} runs on {', '.join(platforms)}")
    if len(platforms) < 2:
        sys.exit(77)
    results_write(done, time.time() - start)


main()
