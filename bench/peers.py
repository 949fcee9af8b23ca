#!/usr/bin/env python3
"""peers.py - Tetracubes and other isosurface filters on the very same samples, in turns

For every case tetracubes-bench writes the samples to one file; then that file is what all read: Tetracubes maps it, the
others wrap a numpy memmap of it. Tetracubes verifies its mesh against its reference before anything is timed. Then they
take turns, in the reverse order on every other repeat, so that all see the same state of the machine. The slow
ones have turns with ours of their own (beside_ms): they use gigabytes, after which the system has to find the pages of
any new mesh anew.

  ours    tetracubes-bench --turns: first launch to mesh complete, a new grid and mesh on every repeat (extract_ms)
  hybrid  the same by --method hybrid, up to 512^3 samples: about as many triangles as the others make; also on
          hexahedra, which are kept whole
  snap    likewise by --method snap: fewer
  vtk     vtkFlyingEdges3D.Update(): a new filter on every repeat; normals, gradients and scalars off; its SMP threads
          are all cores unless --threads says otherwise
  vtk_mc  vtkMarchingCubes.Update(), likewise, up to 512^3 samples; it has one thread
  vtk_contour  vtkContourFilter.Update() in place of all others on a curvilinear grid, FIELD:N:TYPE:curvilinear, a
          vtkStructuredGrid of the points that tetracubes-bench --grid curvilinear makes
  vtk_linear  vtkContour3DLinearGrid.Update() in place of all others on an unstructured grid, FIELD:N:TYPE:tetrahedra or
          :hexahedra, the same points and tetrahedra or cubes; points merged, all cores. Then both again for a repeated
          isovalue (second_ms): ours on a grid that an isovalue has been extracted from before, VTK's with a scalar tree
          that one has built
  skimage skimage.measure.marching_cubes, up to 256^3 samples; it has one thread, and always makes normals and values
  meshlib MeshLib's marchingCubes, up to 256^3 samples, of floats that are made before

A peer whose first turn, which does not count, takes over a second has three turns, over five seconds one. Of a cube of
1024 or more, ours at half the size takes turns too (half_ms), so that one run shows how time grows with size.

On a device with memory of its own our mesh is complete there, not yet on the host; theirs are always on the host. What
is released is released outside the timed parts. Medians and their ratios to ours are printed; above 1 Tetracubes is
faster, though it makes about 2.4 times the triangles. What free memory does not allow is left out, with a notice.

bench/peers-setup installs the newest of each; build-peers/bin/python3 is the Python that has them.
"""

import argparse
import json
import math
import os
import re
import statistics
import subprocess
import sys
import tempfile
import time
from typing import NamedTuple

HERE = os.path.dirname(os.path.abspath(__file__))
DEFAULT_CASES = [f"{field}:{size}:{kind}" for field, kind, sizes in
                 (("sphere", "u8", (64, 128, 256, 512, 1024)), ("gyroid", "u8", (64, 128, 256, 512)),
                  ("sphere", "f32", (64, 128, 256, 512))) for size in sizes] + [
                      "sphere:256:f32:curvilinear", "sphere:127:f32:tetrahedra", "sphere:127:f32:hexahedra"]
REAL_VOLUME, REAL_ISO = "uniform/embryo.nrrd", 80.0  # of the folder TETRACUBES_DATA
REST = 0.01  # seconds before every turn: the others' threads have gone to sleep by then
SLOW_TURNS = [(5000.0, 1), (1000.0, 3)]  # from so many milliseconds on, so many turns
HALVED_FROM = 1024
METHODS = ["hybrid", "snap"]  # beside tetra
WHOLE_METHODS = ["hybrid"]  # of unstructured grids whose cells are no tetrahedra
METHODS_MOST = 512 ** 3  # samples
LARGE_PEERS = ("vtk_mc", "skimage", "meshlib")  # which have turns of their own
MEMORY_FACTOR = 4  # times the samples: the file in the page cache, what the filters make beside it, meshes

try:
    import numpy

    import peer_filters
except ImportError as missing:
    if not {"-h", "--help"} & set(sys.argv):
        sys.exit(f"peers.py: {missing}; run bench/peers-setup, then start this script by build-peers/bin/python3")

NUMPY_TYPES = {"u8": "u1", "i8": "i1", "u16": "u2", "i16": "i2", "u32": "u4", "i32": "i4", "f32": "f4", "f64": "f8"}


# Corners x + 2 y + 4 z of a cube's tetrahedra, by parity
TETRAHEDRA = [[[0, 5, 3, 6], [1, 0, 5, 3], [2, 0, 3, 6], [4, 0, 6, 5], [7, 3, 5, 6]],
              [[1, 2, 4, 7], [0, 4, 1, 2], [3, 2, 1, 7], [5, 7, 1, 4], [6, 4, 2, 7]]]
UNSTRUCTURED = ("tetrahedra", "hexahedra")
CELL_BYTES = {"tetrahedra": 240, "hexahedra": 190}  # per sample, VTK's and ours


class Failure(Exception):
    """Ends the script with its text."""


def spread(times):
    return {"median": round(statistics.median(times), 4), "min": round(min(times), 4), "max": round(max(times), 4)}


class Samples:
    """The samples of one case in a raw file, and how the two sides open it."""

    def __init__(self, bench, path, options, grid="uniform"):
        self.path, self.grid = path, grid
        command = [bench, *options, "--dump", self.path]
        done = subprocess.run(command, stdout=subprocess.PIPE, text=True, check=False)
        if done.returncode:
            raise Failure(f"tetracubes-bench --dump ended with status {done.returncode}")
        made = json.loads(done.stdout)
        self.dims, self.type = made["dims"], made["type"]

    def options(self):
        return ["--input", self.path, "--dims", ",".join(map(str, self.dims)), "--type", self.type, "--grid", self.grid]

    def array(self):
        """Copy-on-write: nobody writes, but VTK asks for writable memory."""
        return numpy.memmap(self.path, dtype=NUMPY_TYPES[self.type], mode="c", shape=tuple(reversed(self.dims)))

    def points(self):
        """Those of a curvilinear grid, as bench/samples.c makes them."""
        x, y, z = (2.0 * numpy.arange(n) / (n - 1) - 1.0 for n in self.dims)
        points = numpy.empty((*reversed(self.dims), 3), dtype="f4")
        points[..., 0] = x[None, None, :] + 0.05 * numpy.sin(3.0 * y)[None, :, None]
        points[..., 1] = y[None, :, None] + 0.05 * numpy.sin(3.0 * z)[:, None, None]
        points[..., 2] = z[:, None, None] + 0.05 * numpy.sin(3.0 * x)[None, None, :]
        return points.reshape(-1, 3)

    def cells(self):
        """Tetrahedra of an unstructured grid, five of each cube, or its hexahedra, by their corners."""
        nx, ny, nz = self.dims
        k, j, i = numpy.meshgrid(*(numpy.arange(n - 1) for n in (nz, ny, nx)), indexing="ij")
        first = ((k * ny + j) * nx + i).reshape(-1)
        steps = numpy.array([(c & 1) + nx * (c >> 1 & 1) + nx * ny * (c >> 2) for c in range(8)])
        if self.grid == "hexahedra":
            return first[:, None] + steps[[0, 1, 3, 2, 4, 5, 7, 6]]
        odd = ((i + j + k) & 1).reshape(-1)
        return (first[:, None, None] + steps[numpy.array(TETRAHEDRA)][odd]).reshape(-1, 4)

    def count(self):
        return self.dims[0] * self.dims[1] * self.dims[2]


class Ours:
    """tetracubes-bench, kept running between turns."""

    def __init__(self, bench, samples, iso, device, warm_repeats, method="tetra"):
        command = [bench, *samples.options(), "--iso", repr(iso), "--turns", "--repeat", str(warm_repeats),
                   "--method", method]
        if device:
            command += ["--device", device]
        self.process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, bufsize=1)
        if self.process.stdout.readline().strip() != "ready":
            self.fail()

    def fail(self):
        self.process.stdin.close()
        raise Failure(f"tetracubes-bench ended with status {self.process.wait()}")

    def turn(self, second=False):
        """Milliseconds of one extraction into a new mesh, of the second isovalue after the first on the same grid."""
        try:
            self.process.stdin.write("second\n" if second else "\n")
            self.process.stdin.flush()
        except BrokenPipeError:
            pass
        line = self.process.stdout.readline()
        return float(line) if line else self.fail()

    def report(self):
        self.process.stdin.close()
        text = self.process.stdout.read()
        if self.process.wait():
            self.fail()
        return json.loads(text)

    def stop(self):
        if self.process.poll() is None:
            self.process.kill()
            self.process.wait()


class Second:
    """A side's turns with the second isovalue."""

    def __init__(self, side):
        self.side = side

    def turn(self):
        return self.side.turn(second=True)


def progress(text):
    if sys.stderr.isatty():
        print(f"\r\033[K{text}", end="", file=sys.stderr, flush=True)


def turns_of(side, repeat):
    """How many turns a side has, by the time of a first one."""
    ms = side.turn()
    return next((min(turns, repeat) for slow_ms, turns in SLOW_TURNS if ms > slow_ms and not isinstance(side, Ours)),
                repeat)


def take_turns(name, sides, repeat):
    """The times of every side."""
    progress(f"{name}: first turns")
    turns = {key: turns_of(side, repeat) for key, side in sides.items()}
    times = {key: [] for key in sides}
    for n in range(repeat):
        progress(f"{name}: turn {n + 1} of {repeat}")
        for key in list(sides)[::-1 if n % 2 else 1]:
            if n < turns[key]:
                time.sleep(REST)
                times[key].append(sides[key].turn())
    return times


def result_of(case, samples, reports, times, peers):
    """What the JSON file tells of a case; reports are those of tetracubes-bench."""
    report = reports["ours"]
    measured = report["cases"][0]
    first = next(iter(peers))
    result = {
        "case": case.name,
        "dims": samples.dims,
        "type": samples.type,
        "grid": samples.grid,
        "iso": case.iso,
        "extract_ms": spread(times["ours"]),
        "ratio": round(statistics.median(times[first]) / statistics.median(times["ours"]), 3),
        "triangles": measured["triangles"],
        "extract_warm_ms": measured["extract_warm_ms"],
        "limit_ms": measured["limit_ms"],
        "limit_ratio": measured["limit_ratio"],
        "read_gbps": report["read_gbps"],
        "write_gbps": report["write_gbps"],
        "device": report["device"],
    }
    for key, peer in peers.items():
        result.update({f"{key}_ms": spread(times[key]), f"{key}_triangles": peer.triangles})
    if "ours_second" in times:
        result.update({"second_ms": spread(times["ours_second"]),
                       "vtk_linear_second_ms": spread(times["vtk_linear_second"])})
    if "beside" in times:
        result["beside_ms"] = spread(times["beside"])
    if "half" in times:
        result["half_ms"] = spread(times["half"])
    for method in set(METHODS) & set(times):
        result[f"{method}_ms"] = spread(times[method])
        result[f"{method}_triangles"] = reports[method]["cases"][0]["triangles"]
        result[f"{method}_ratio"] = round(statistics.median(times[first]) / statistics.median(times[method]), 3)
        if f"{method}_second" in times:
            result[f"{method}_second_ms"] = spread(times[f"{method}_second"])
    return result


def methods_of(samples):
    """Those that are measured beside tetra."""
    most = METHODS if samples.grid == "uniform" else WHOLE_METHODS if samples.grid == "hexahedra" else []
    return most if samples.count() <= METHODS_MOST else []


def run_case(arguments, case, folder):
    """Its result."""
    progress(f"{case.name}: making samples")
    samples = Samples(arguments.bench, os.path.join(folder, "samples.raw"), case.options, case.grid)
    opened = {"ours": samples}
    if case.half_options:
        opened["half"] = Samples(arguments.bench, os.path.join(folder, "half.raw"), case.half_options, case.grid)
    ours = {}
    try:
        for key, its in opened.items():
            progress(f"{case.name}: verifying")
            ours[key] = Ours(arguments.bench, its, case.iso, arguments.device, arguments.repeat)
        for method in methods_of(samples):
            progress(f"{case.name}: verifying method {method}")
            ours[method] = Ours(arguments.bench, samples, case.iso, arguments.device, arguments.repeat, method)
        peers = peer_filters.filters_of(samples, case.iso)
        large = {key: peer for key, peer in peers.items() if key in LARGE_PEERS}
        fast = {key: peer for key, peer in peers.items() if key not in large}
        times = take_turns(case.name, {**ours, **fast}, arguments.repeat)
        if large:
            times.update(take_turns(case.name, {"beside": ours["ours"], **large}, arguments.repeat))
        if case.grid in UNSTRUCTURED:
            seconds = {f"{key}_second": Second(side) for key, side in {**ours, **peers}.items()}
            times.update(take_turns(case.name, seconds, arguments.repeat))
        reports = {key: side.report() for key, side in ours.items()}
    finally:
        for side in ours.values():
            side.stop()
        progress("")
    return result_of(case, samples, reports, times, peers)


def shown(times):
    return f"{times['median']:.1f} ({times['min']:.1f} - {times['max']:.1f})"


def shown_ratio(result, key):
    """A peer's median and how many times ours it is."""
    if f"{key}_ms" not in result:
        return "-"
    median = result[f"{key}_ms"]["median"]
    ours = result["beside_ms"] if key in LARGE_PEERS else result["extract_ms"]
    return f"{median:.1f} ({median / ours['median']:.2f})"


FILTERS = {"uniform": "vtkFlyingEdges3D", "hexahedra": "vtkContour3DLinearGrid"}  # beside other methods

COLUMNS = "{:<32} {:>24} {:>18} {:>18} {:>18} {:>18} {:>18} {:>11} {:>11} {:>11}"


PEER_TRIANGLES = ("vtk_triangles", "vtk_contour_triangles", "vtk_linear_triangles")


def print_head():
    print(COLUMNS.format("case", "Tetracubes", "vtkFlyingEdges3D", "vtkMarchingCubes", "scikit-image", "MeshLib",
                         "of this grid", "triangles", "of VTK", "limit ratio"))


def print_row(result):
    print(COLUMNS.format(result["case"], shown(result["extract_ms"]), shown_ratio(result, "vtk"),
                         shown_ratio(result, "vtk_mc"), shown_ratio(result, "skimage"), shown_ratio(result, "meshlib"),
                         shown_ratio(result, "vtk_linear" if result["grid"] in UNSTRUCTURED else "vtk_contour"),
                         result["triangles"], next(result[key] for key in PEER_TRIANGLES if key in result),
                         f"{result['limit_ratio']:.2f}"), flush=True)
    if "second_ms" in result:
        second, vtk_second = result["second_ms"], result["vtk_linear_second_ms"]
        print(f"    another isovalue: {shown(second)}, with a scalar tree {shown(vtk_second)}, "
              f"ratio {vtk_second['median'] / second['median']:.2f}", flush=True)
    if "half_ms" in result:
        growth = result["extract_ms"]["median"] / result["half_ms"]["median"]
        print(f"    {growth:.2f} times the time of half the size, {shown(result['half_ms'])}", flush=True)
    for method in METHODS:
        if f"{method}_ms" in result:
            print(f"    {method}: {shown(result[f'{method}_ms'])}, {result[f'{method}_triangles']} triangles; "
                  f"{FILTERS[result['grid']]} takes {result[f'{method}_ratio']:.2f} times as long", flush=True)
        if f"{method}_second_ms" in result:
            second, vtk_second = result[f"{method}_second_ms"], result["vtk_linear_second_ms"]
            print(f"    {method}, another isovalue: {shown(second)}, "
                  f"ratio {vtk_second['median'] / second['median']:.2f}", flush=True)


def find_bench():
    """The newest tetracubes-bench of the build folders beside this one, else that of the PATH."""
    root = os.path.dirname(HERE)
    found = [os.path.join(root, folder, "bench", "tetracubes-bench")
             for folder in os.listdir(root) if folder.startswith("build")]
    found = sorted(filter(os.path.exists, found), key=os.path.getmtime)
    return found[-1] if found else "tetracubes-bench"


class Case(NamedTuple):
    """Options make the samples; half_options make those of half the size, where they are measured too."""
    name: str
    options: list
    iso: float
    half_options: list = []
    sample_bytes: int = 0  # 0: not known, a file's; of curvilinear grids with the points
    grid: str = "uniform"


def parse_case(text):
    """sphere:512:u8, or sphere:512:u8:curvilinear and its like"""
    parts = text.split(":")
    grid = parts.pop() if len(parts) == 4 and parts[3] in ("uniform", "curvilinear", *UNSTRUCTURED) else "uniform"
    if len(parts) != 3 or parts[2] not in NUMPY_TYPES or not re.fullmatch(r"\d+(,\d+,\d+)?", parts[1]):
        raise Failure(f"--cases: '{text}' is not FIELD:N:TYPE or FIELD:N:TYPE:GRID, GRID curvilinear, tetrahedra or "
                      "hexahedra, as in sphere:512:u8")
    field, dims, kind = parts
    options = ["--field", field, "--type", kind, "--dims"]
    half = [*options, str(int(dims) // 2)] if "," not in dims and int(dims) >= HALVED_FROM else []
    sizes = [int(size) for size in dims.split(",")]
    count = sizes[0] ** 3 if len(sizes) == 1 else math.prod(sizes)
    name = f"{field} {dims if ',' in dims else f'{dims}^3'} {kind}{'' if grid == 'uniform' else ' ' + grid}"
    item_bytes = numpy.dtype(NUMPY_TYPES[kind]).itemsize + (0 if grid == "uniform" else 12) + CELL_BYTES.get(grid, 0)
    return Case(name, [*options, dims], 127.5, half, count * item_bytes, grid)


def default_cases():
    """With the real volume, where there is one."""
    cases = [parse_case(text) for text in DEFAULT_CASES]
    if os.environ.get("TETRACUBES_DATA"):
        path = os.path.join(os.environ["TETRACUBES_DATA"], REAL_VOLUME)
        cases.append(Case(os.path.basename(path), ["--input", path], REAL_ISO))
    else:
        print(f"TETRACUBES_DATA is unset: without {REAL_VOLUME}", file=sys.stderr)
    return cases


def cases_of(arguments):
    if not arguments.input:
        return [parse_case(text) for text in arguments.cases] if arguments.cases else default_cases()
    if arguments.iso is None:
        raise Failure("--input needs an isovalue: --iso V")
    options = ["--input", arguments.input]
    if arguments.dims:
        options += ["--dims", arguments.dims]
    if arguments.type:
        options += ["--type", arguments.type]
    return [Case(os.path.basename(arguments.input), options, arguments.iso)]


def fits(case):
    """Whether free memory allows the case; says so where it does not."""
    with open("/proc/meminfo", encoding="ascii") as file:
        available = 1024 * int(re.search(r"^MemAvailable: +(\d+) kB$", file.read(), re.MULTILINE).group(1))
    if MEMORY_FACTOR * case.sample_bytes <= available * 3 // 4:
        return True
    print(f"peers.py: {case.name} is left out: it needs {MEMORY_FACTOR * case.sample_bytes >> 20} MB of memory, "
          f"{(available * 3 // 4) >> 20} MB may be had", file=sys.stderr)
    return False


def parse_arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--cases", nargs="+", metavar="F:N:T",
                        help=f"field, size (N or NX,NY,NZ) and type; default {' '.join(DEFAULT_CASES)} and, where "
                             f"TETRACUBES_DATA is set, its {REAL_VOLUME}")
    parser.add_argument("--input", metavar="FILE", help="a volume instead, in any format that Tetracubes reads")
    parser.add_argument("--iso", type=float, metavar="V", help="isovalue of --input")
    parser.add_argument("--dims", metavar="NX,NY,NZ", help="of raw --input")
    parser.add_argument("--type", choices=NUMPY_TYPES, help="of raw --input")
    parser.add_argument("--repeat", type=int, default=11, metavar="R", help="turns of each, default 11")
    parser.add_argument("--device", metavar="SPEC", help="OpenCL device of Tetracubes")
    parser.add_argument("--threads", type=int, default=0, metavar="N", help="of VTK, default all cores")
    parser.add_argument("--bench", metavar="FILE", help="tetracubes-bench; default that of the last build")
    parser.add_argument("--folder", metavar="DIR", help="for the samples (up to 1.2 GB), default a temporary one")
    parser.add_argument("--json", metavar="FILE", help="write the results here too")
    arguments = parser.parse_args()
    if arguments.repeat < 1:
        parser.error("--repeat: at least 1")
    arguments.bench = arguments.bench or find_bench()
    return arguments


def main():
    arguments = parse_arguments()
    cases = cases_of(arguments)
    vtk, versions = peer_filters.vtk_start(arguments.threads), peer_filters.versions()
    print(f"VTK {vtk['version']}, {vtk['threads']} threads ({vtk['backend']}), scikit-image {versions['skimage']}, "
          f"MeshLib {versions['meshlib']}; milliseconds: median (min - max), of the others median (times ours)\n")
    print_head()
    results = []
    with tempfile.TemporaryDirectory(prefix="tetracubes-peers-", dir=arguments.folder) as folder:
        for case in filter(fits, cases):
            results.append(run_case(arguments, case, folder))
            print_row(results[-1])
    if arguments.json:
        with open(arguments.json, "w", encoding="utf-8") as file:
            json.dump({"vtk": vtk, "versions": versions, "cases": results}, file, indent=2)
            file.write("\n")


if __name__ == "__main__":
    try:
        main()
    except (Failure, OSError) as failure:
        sys.exit(f"peers.py: {failure}")
    except KeyboardInterrupt:
        sys.exit("peers.py: interrupted")
