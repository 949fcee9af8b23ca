#!/usr/bin/python3
"""peers.py - Tetracubes and VTK's fastest isosurface filter on the very same samples, in turns

For every case tetracubes-bench writes the samples to one file; then that file is what both read: Tetracubes maps it,
VTK's image wraps a numpy memmap of it. Tetracubes verifies its mesh against its reference before anything is timed.
Then the two take turns, repeat by repeat, so that both see the same state of the machine:

  ours  tetracubes-bench --turns: first launch to mesh complete, a new mesh on every repeat (extract_ms)
  VTK   vtkFlyingEdges3D.Update(): a new filter on every repeat; normals, gradients and scalars off; its SMP threads
        are all cores unless --threads says otherwise

On a device with memory of its own our mesh is complete there, not yet on the host; VTK's is always on the host.
What is released is released outside the timed parts. Medians and their ratio are printed; a ratio above 1 means that
Tetracubes is faster, though it makes about 2.4 times the triangles. With --skimage, skimage.measure.marching_cubes is
timed too, a few times, after the turns: it is several times slower.

Needs Debian's own Python with VTK and numpy: bench/peers-setup installs them.
"""

import argparse
import json
import os
import statistics
import subprocess
import sys
import tempfile
import time

HERE = os.path.dirname(os.path.abspath(__file__))
DEFAULT_CASES = ["sphere:512:u8", "gyroid:512:u8", "sphere:512:f32", "sphere:256:u8"]
REST = 0.01  # seconds before every turn: the other side's threads have gone to sleep by then

try:
    import numpy
    from vtkmodules.util.numpy_support import get_vtk_array_type, numpy_to_vtk
    from vtkmodules.vtkCommonCore import vtkSMPTools, vtkVersion
    from vtkmodules.vtkCommonDataModel import vtkImageData
    from vtkmodules.vtkFiltersCore import vtkFlyingEdges3D
except ImportError as missing:
    if not {"-h", "--help"} & set(sys.argv):
        sys.exit(f"peers.py: {missing}; run bench/peers-setup, then start this script by /usr/bin/python3")

NUMPY_TYPES = {"u8": "u1", "i8": "i1", "u16": "u2", "i16": "i2", "u32": "u4", "i32": "i4", "f32": "f4", "f64": "f8"}


class Failure(Exception):
    """Ends the script with its text."""


def spread(times):
    return {"median": round(statistics.median(times), 4), "min": round(min(times), 4), "max": round(max(times), 4)}


class Samples:
    """The samples of one case in a raw file, and how the two sides open it."""

    def __init__(self, bench, folder, options):
        self.path = os.path.join(folder, "samples.raw")
        command = [bench, *options, "--dump", self.path]
        done = subprocess.run(command, stdout=subprocess.PIPE, text=True, check=False)
        if done.returncode:
            raise Failure(f"tetracubes-bench --dump ended with status {done.returncode}")
        made = json.loads(done.stdout)
        self.dims, self.type = made["dims"], made["type"]

    def options(self):
        return ["--input", self.path, "--dims", ",".join(map(str, self.dims)), "--type", self.type]

    def array(self):
        """Copy-on-write: nobody writes, but VTK asks for writable memory."""
        return numpy.memmap(self.path, dtype=NUMPY_TYPES[self.type], mode="c", shape=tuple(reversed(self.dims)))


class Ours:
    """tetracubes-bench, kept running between turns."""

    def __init__(self, bench, samples, iso, device, warm_repeats):
        command = [bench, *samples.options(), "--iso", repr(iso), "--turns", "--repeat", str(warm_repeats)]
        if device:
            command += ["--device", device]
        self.process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, bufsize=1)
        if self.process.stdout.readline().strip() != "ready":
            self.fail()

    def fail(self):
        self.process.stdin.close()
        raise Failure(f"tetracubes-bench ended with status {self.process.wait()}")

    def turn(self):
        """Milliseconds of one extraction into a new mesh."""
        try:
            self.process.stdin.write("\n")
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


class FlyingEdges:
    """vtkFlyingEdges3D on an image that wraps the samples."""

    def __init__(self, samples, iso):
        values = samples.array().reshape(-1)
        scalars = numpy_to_vtk(values, deep=0, array_type=get_vtk_array_type(values.dtype))
        self.keep = values
        self.image = vtkImageData()
        self.image.SetDimensions(samples.dims)
        self.image.GetPointData().SetScalars(scalars)
        self.iso = iso
        self.triangles = 0

    def turn(self):
        """Milliseconds of Update() of a new filter."""
        edges = vtkFlyingEdges3D()
        edges.SetInputData(self.image)
        edges.ComputeNormalsOff()
        edges.ComputeGradientsOff()
        edges.ComputeScalarsOff()
        edges.SetValue(0, self.iso)
        begin = time.perf_counter()
        edges.Update()
        ms = 1e3 * (time.perf_counter() - begin)
        self.triangles = edges.GetOutput().GetNumberOfPolys()
        return ms


def skimage_times(samples, iso, repeat):
    """Medians of scikit-image's marching_cubes, and its triangles."""
    try:
        from skimage.measure import marching_cubes
    except ImportError as missing:
        raise Failure(f"{missing}; run bench/peers-setup") from missing
    values = samples.array()
    times, triangles = [], 0
    for _ in range(repeat):
        begin = time.perf_counter()
        mesh = marching_cubes(values, iso)
        times.append(1e3 * (time.perf_counter() - begin))
        triangles = len(mesh[1])
        del mesh
    return {"skimage_ms": spread(times), "skimage_triangles": triangles}


def progress(text):
    if sys.stderr.isatty():
        print(f"\r\033[K{text}", end="", file=sys.stderr, flush=True)


def run_case(arguments, case, folder):
    """One line of the report."""
    name, options, iso = case
    progress(f"{name}: making samples")
    samples = Samples(arguments.bench, folder, options)
    theirs = FlyingEdges(samples, iso)
    progress(f"{name}: verifying")
    ours = Ours(arguments.bench, samples, iso, arguments.device, arguments.repeat)
    our_times, their_times = [], []
    try:
        ours.turn()
        theirs.turn()
        for n in range(arguments.repeat):
            progress(f"{name}: turn {n + 1} of {arguments.repeat}")
            for side, times in (ours, our_times), (theirs, their_times):
                time.sleep(REST)
                times.append(side.turn())
        report = ours.report()
    finally:
        ours.stop()
    measured = report["cases"][0]
    result = {
        "case": name,
        "dims": samples.dims,
        "type": samples.type,
        "iso": iso,
        "extract_ms": spread(our_times),
        "vtk_ms": spread(their_times),
        "ratio": round(statistics.median(their_times) / statistics.median(our_times), 3),
        "triangles": measured["triangles"],
        "vtk_triangles": theirs.triangles,
        "extract_warm_ms": measured["extract_warm_ms"],
        "limit_ms": measured["limit_ms"],
        "limit_ratio": measured["limit_ratio"],
        "read_gbps": report["read_gbps"],
        "write_gbps": report["write_gbps"],
        "device": report["device"],
    }
    if arguments.skimage:
        progress(f"{name}: scikit-image")
        result.update(skimage_times(samples, iso, min(3, arguments.repeat)))
    progress("")
    return result


def shown(times):
    return f"{times['median']:.1f} ({times['min']:.1f} - {times['max']:.1f})"


COLUMNS = "{:<24} {:>26} {:>28} {:>7} {:>11} {:>11} {:>11}"


def print_row(result):
    row = COLUMNS.format(result["case"], shown(result["extract_ms"]), shown(result["vtk_ms"]), f"{result['ratio']:.2f}",
                         result["triangles"], result["vtk_triangles"], f"{result['limit_ratio']:.2f}")
    print(row, flush=True)
    if "skimage_ms" in result:
        print(f"    scikit-image marching_cubes: {shown(result['skimage_ms'])} ms, "
              f"{result['skimage_triangles']} triangles", flush=True)


def find_bench():
    """The newest tetracubes-bench of the build folders beside this one, else that of the PATH."""
    root = os.path.dirname(HERE)
    found = [os.path.join(root, folder, "bench", "tetracubes-bench")
             for folder in os.listdir(root) if folder.startswith("build")]
    found = sorted(filter(os.path.exists, found), key=os.path.getmtime)
    return found[-1] if found else "tetracubes-bench"


def parse_case(text):
    """sphere:512:u8 to a name, the options that make it, and its isovalue."""
    parts = text.split(":")
    if len(parts) != 3 or parts[2] not in NUMPY_TYPES:
        raise Failure(f"--cases: '{text}' is not FIELD:N:TYPE, as in sphere:512:u8")
    field, dims, kind = parts
    size = dims if "," in dims else f"{dims}^3"
    return f"{field} {size} {kind}", ["--field", field, "--dims", dims, "--type", kind], 127.5


def cases_of(arguments):
    if not arguments.input:
        return [parse_case(text) for text in arguments.cases]
    if arguments.iso is None:
        raise Failure("--input needs an isovalue: --iso V")
    options = ["--input", arguments.input]
    if arguments.dims:
        options += ["--dims", arguments.dims]
    if arguments.type:
        options += ["--type", arguments.type]
    return [(os.path.basename(arguments.input), options, arguments.iso)]


def parse_arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--cases", nargs="+", default=DEFAULT_CASES, metavar="F:N:T",
                        help=f"field, size (N or NX,NY,NZ) and type; default {' '.join(DEFAULT_CASES)}")
    parser.add_argument("--input", metavar="FILE", help="a volume instead, in any format that Tetracubes reads")
    parser.add_argument("--iso", type=float, metavar="V", help="isovalue of --input")
    parser.add_argument("--dims", metavar="NX,NY,NZ", help="of raw --input")
    parser.add_argument("--type", choices=NUMPY_TYPES, help="of raw --input")
    parser.add_argument("--repeat", type=int, default=11, metavar="R", help="turns of each, default 11")
    parser.add_argument("--device", metavar="SPEC", help="OpenCL device of Tetracubes")
    parser.add_argument("--threads", type=int, default=0, metavar="N", help="of VTK, default all cores")
    parser.add_argument("--skimage", action="store_true", help="time scikit-image too")
    parser.add_argument("--bench", metavar="FILE", help="tetracubes-bench; default that of the last build")
    parser.add_argument("--folder", metavar="DIR", help="for the samples (up to 512 MB), default a temporary one")
    parser.add_argument("--json", metavar="FILE", help="write the results here too")
    arguments = parser.parse_args()
    if arguments.repeat < 1:
        parser.error("--repeat: at least 1")
    arguments.bench = arguments.bench or find_bench()
    return arguments


def main():
    arguments = parse_arguments()
    cases = cases_of(arguments)
    vtkSMPTools.Initialize(arguments.threads)
    vtk = {"version": vtkVersion.GetVTKVersion(), "threads": vtkSMPTools.GetEstimatedNumberOfThreads(),
           "backend": vtkSMPTools.GetBackend()}
    print(f"VTK {vtk['version']}, {vtk['threads']} threads ({vtk['backend']}); milliseconds: median (min - max)\n")
    print(COLUMNS.format("case", "Tetracubes", "vtkFlyingEdges3D", "ratio", "triangles", "of VTK", "limit ratio"))
    results = []
    with tempfile.TemporaryDirectory(prefix="tetracubes-peers-", dir=arguments.folder) as folder:
        for case in cases:
            results.append(run_case(arguments, case, folder))
            print_row(results[-1])
    if arguments.json:
        with open(arguments.json, "w", encoding="utf-8") as file:
            json.dump({"vtk": vtk, "cases": results}, file, indent=2)
            file.write("\n")


if __name__ == "__main__":
    try:
        main()
    except (Failure, OSError) as failure:
        sys.exit(f"peers.py: {failure}")
    except KeyboardInterrupt:
        sys.exit("peers.py: interrupted")
