#!/usr/bin/env python3
"""process.py - what a whole process of the tool costs: start to end on a small volume, memory on a large one

  startup_ms      `tetracubes extract` on a 64^3 u8 file, kernels in the cache of the OpenCL platform: the wall time of
                  the process, over 20 runs
  peak_extra_mb   peak resident memory of `tetracubes extract -o mesh.ply` on a 512^3 u8 raw file beyond the mapped file
                  and the mesh, in 10^6 bytes: the larger one of sphere and gyroid

Linux only (ru_maxrss in KiB). Standard library only: a child's peak begins with that of the process that starts it, so
that a large interpreter would be counted too.
"""

import argparse
import json
import os
import statistics
import subprocess
import sys
import tempfile
import time
from typing import NamedTuple

ISO = ["--iso", "127.5"]
RUNS = 20
SIZE = 512


class Failure(Exception):
    """Ends the script with its text."""


class Run(NamedTuple):
    """What a process took, with the children that it waited for; the peak is the largest of theirs."""
    seconds: float
    peak: int  # resident bytes
    text: str  # standard output
    cpu_seconds: float


def run(command, **how):
    begin = time.perf_counter()
    with tempfile.TemporaryFile() as out:
        process = subprocess.Popen(command, stdout=out, **how)
        _, status, usage = os.wait4(process.pid, 0)
        seconds = time.perf_counter() - begin
        process.returncode = os.waitstatus_to_exitcode(status)
        out.seek(0)
        text = out.read().decode()
    if process.returncode:
        raise Failure(f"{' '.join(command)}: status {process.returncode}")
    return Run(seconds, usage.ru_maxrss * 1024, text, usage.ru_utime + usage.ru_stime)


def startup(tool, device, folder):
    volume, mesh = os.path.join(folder, "small.nrrd"), os.path.join(folder, "small.ply")
    run([tool, "generate", "sphere", "--dims", "64,64,64", "--type", "u8", "-o", volume])
    command = [tool, "extract", volume, *ISO, "-o", mesh, *device]
    run(command)
    times = [1e3 * run(command).seconds for _ in range(RUNS)]
    return {"median": round(statistics.median(times), 2), "min": round(min(times), 2), "max": round(max(times), 2)}


def peak_extra(tool, device, folder, field):
    """10^6 bytes beyond file and mesh."""
    volume, mesh = os.path.join(folder, "large.raw"), os.path.join(folder, "large.ply")
    dims = ",".join([str(SIZE)] * 3)
    run([tool, "generate", field, "--dims", dims, "--type", "u8", "-o", volume])
    command = [tool, "extract", volume, "--dims", dims, "--type", "u8", *ISO, "-o", mesh, "--json", *device]
    run([tool, "extract", volume, "--dims", dims, "--type", "u8", *ISO, "--count", *device])
    done = run(command)
    surface = json.loads(done.text)["surfaces"][0]
    mesh_bytes = 12 * (surface["vertices"] + surface["triangles"])
    return round((done.peak - os.path.getsize(volume) - mesh_bytes) / 1e6, 1)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("tool", help="the program tetracubes")
    parser.add_argument("--device", metavar="SPEC", help="OpenCL device")
    parser.add_argument("--json", metavar="FILE", help="write the results here too")
    arguments = parser.parse_args()
    device = ["--device", arguments.device] if arguments.device else []
    with tempfile.TemporaryDirectory(prefix="tetracubes-process-") as folder:
        peaks = [peak_extra(arguments.tool, device, folder, field) for field in ("sphere", "gyroid")]
        results = {"startup_ms": startup(arguments.tool, device, folder), "peak_extra_mb": max(peaks)}
    times = results["startup_ms"]
    print(f"whole process, 64^3 u8: {times['median']:.1f} ms ({times['min']:.1f} - {times['max']:.1f})")
    print(f"peak memory beyond file and mesh, 512^3 u8: sphere {peaks[0]:.1f} MB, gyroid {peaks[1]:.1f} MB")
    if arguments.json:
        with open(arguments.json, "w", encoding="utf-8") as file:
            json.dump(results, file, indent=2)
            file.write("\n")


if __name__ == "__main__":
    try:
        main()
    except (Failure, OSError) as failure:
        sys.exit(f"process.py: {failure}")
