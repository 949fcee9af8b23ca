#!/usr/bin/env python3
"""stream.py - volumes larger than memory: `extract --stream`, file to file, beside the same in memory and plain reading

Two kinds of cases:

  files     raw volumes of 512^3 and 1024^3, extracted to PLY in memory, as a stream, and as a stream under --max-memory:
            wall time and peak resident memory of each process, in turns; files compared byte by byte
  large     a raw volume of 16 GiB, most of it a hole, under a limit of 1 GiB on the memory that the process may take
            (RLIMIT_DATA): wall time and peak, beside what dd takes to read the file; warm, and cold where the script may
            drop the system's cache of files

Linux only. Standard library only, as in process.py.
"""

import argparse
import filecmp
import json
import os
import resource
import statistics
import subprocess
import sys
import tempfile
import time

import process

WAYS = {"memory": [], "stream": ["--stream"], "stream_128m": ["--stream", "--max-memory", "128M"]}
LARGE = (2048, 2048, 4096)
LARGE_LIMIT = 1 << 30
BALL = 100  # planes on either side of the middle that hold something


def middle(times):
    return {"median": round(statistics.median(times), 1), "min": round(min(times), 1), "max": round(max(times), 1)}


def file_case(tool, folder, field, side, repeat):
    volume = os.path.join(folder, "volume.raw")
    dims = ",".join([str(side)] * 3)
    process.run([tool, "generate", field, "--dims", dims, "--type", "u8", "-o", volume])
    times, peaks = {way: [] for way in WAYS}, {}
    for turn in range(repeat + 1):  # the first one fills the cache of files
        for way, more in WAYS.items():
            mesh = os.path.join(folder, way + ".ply")
            command = [tool, "extract", volume, "--dims", dims, "--type", "u8", *process.ISO, "-o", mesh, "--quiet"]
            done = process.run([*command, *more])
            if turn:
                times[way].append(1e3 * done.seconds)
            peaks[way] = round(done.peak / 1e6, 1)
            if not filecmp.cmp(mesh, os.path.join(folder, "memory.ply"), shallow=False):
                raise process.Failure(f"{field} {side}^3: {way} makes another file")
    size = os.path.getsize(os.path.join(folder, "memory.ply"))
    for way in WAYS:
        os.remove(os.path.join(folder, way + ".ply"))
    os.remove(volume)
    return {"field": field, "dims": [side] * 3, "type": "u8", "mesh_mb": round(size / 1e6, 1),
            **{way: {"ms": middle(times[way]), "peak_mb": peaks[way]} for way in WAYS}}


def make_large(path):
    """A flat ball in the middle of zeros that take no room on the disk."""
    nx, ny, nz = LARGE
    with open(path, "wb") as file:
        file.truncate(nx * ny * nz)
        for z in range(nz // 2 - BALL, nz // 2 + BALL):
            half = int((1 - ((z - nz // 2) / BALL) ** 2) ** 0.5 * (nx // 2 - 2)) if abs(z - nz // 2) < BALL else 0
            row = bytes(nx // 2 - half) + bytes([200]) * (2 * half) + bytes(nx // 2 - half)
            file.seek(z * nx * ny + (ny // 2 - half) * nx)
            file.write(row * (2 * half))


def dropped_cache():
    """Drops the system's cache of files; False where that is not allowed."""
    try:
        subprocess.run(["sync"], check=True)
        with open("/proc/sys/vm/drop_caches", "w", encoding="ascii") as file:
            file.write("3\n")
        return True
    except OSError:
        return False


def read_seconds(path):
    begin = time.perf_counter()
    subprocess.run(["dd", f"if={path}", "of=/dev/null", "bs=4M"], check=True, stderr=subprocess.DEVNULL)
    return time.perf_counter() - begin


def limited():
    resource.setrlimit(resource.RLIMIT_DATA, (LARGE_LIMIT, resource.RLIM_INFINITY))


def extract_seconds(tool, volume, mesh):
    """Wall time and peak of the process under the limit."""
    command = ["extract", volume, "--dims", ",".join(map(str, LARGE)), "--type", "u8", "--iso", "99.5", "-o", mesh,
               "--json"]
    done = process.run([tool, *command], preexec_fn=limited)
    surface = json.loads(done.text)["surfaces"][0]
    if "pieces" not in surface:
        raise process.Failure("the large volume was not streamed")
    return done.seconds, done.peak, surface["vertices"]


def large_case(tool, folder):
    volume, mesh = os.path.join(folder, "large.raw"), os.path.join(folder, "large.ply")
    make_large(volume)
    case = {"dims": list(LARGE), "type": "u8", "limit_mb": LARGE_LIMIT / 1e6}
    if dropped_cache():
        cold = read_seconds(volume)
        dropped_cache()
        seconds, _, _ = extract_seconds(tool, volume, mesh)
        case["cold"] = {"dd_s": round(cold, 2), "extract_s": round(seconds, 2)}
    reads, extracts = [], []
    for _ in range(3):
        reads.append(read_seconds(volume))
        seconds, peak, vertices = extract_seconds(tool, volume, mesh)
        extracts.append(seconds)
    case["warm"] = {"dd_s": round(statistics.median(reads), 2), "extract_s": round(statistics.median(extracts), 2)}
    case.update(peak_mb=round(peak / 1e6, 1), vertices=vertices)
    os.remove(volume)
    return case


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("tool", help="the program tetracubes")
    parser.add_argument("--folder", metavar="DIR", help="where files go: 20 GB of room (default: that for temporary ones)")
    parser.add_argument("--repeat", type=int, default=5)
    parser.add_argument("--small", action="store_true", help="small volumes, to try the script itself")
    parser.add_argument("--json", metavar="FILE", help="write the results here too")
    arguments = parser.parse_args()
    cases = [("sphere", 64)] if arguments.small else [("sphere", 512), ("gyroid", 512), ("gyroid", 1024)]
    with tempfile.TemporaryDirectory(prefix="tetracubes-stream-", dir=arguments.folder) as folder:
        results = {"files": [file_case(arguments.tool, folder, *case, arguments.repeat) for case in cases]}
        if not arguments.small:
            results["large"] = large_case(arguments.tool, folder)
    print(json.dumps(results, indent=1))
    if arguments.json:
        with open(arguments.json, "w", encoding="utf-8") as file:
            json.dump(results, file)


if __name__ == "__main__":
    try:
        main()
    except process.Failure as failure:
        sys.exit(f"stream.py: {failure}")
