#!/usr/bin/env python3
"""out_of_core.py - a volume file to a surface file in pieces: Tetracubes, VTK, scikit-image and ParaView, in turns

    out_of_core.py --build DIR [--python FILE] [--folder DIR] [--sizes N...] [--ways WAY...] [--repeat R] [--results DIR]

Raw u8 cubes. Each way is a process of its own: in memory, in pieces with bounded memory, and by two ranks of MPI. Wall
time, processor time (user and system) and peak resident memory are measured; of ranks the peak of the largest one. Ours
are times of whole processes. Of the others it is their work alone, without the start of Python and the loading of modules;
ParaView's processor time is that of all its processes, from start to end. All write VTP, scikit-image raw arrays. All of ours have to be the same file.

out_of_core_peers.py says what the others do. What is not there is left out: bench/peers-setup installs VTK and
scikit-image, Debian has ParaView (apt-get install python3-paraview paraview). The results go into a file named after the
processor; bench/table.py makes the tables of the committed ones.
"""
import argparse
import datetime
import filecmp
import json
import os
import shutil
import statistics
import subprocess
import sys
import tempfile

import collect
import process

HERE = os.path.dirname(os.path.abspath(__file__))
ISO = "127.5"
PIECES = 16
RANKS = 2
SLOW_MS = 20000.0  # from so long on, one turn
OURS = {"memory": [], "stream": ["--stream"], "stream_128m": ["--stream", "--max-memory", "128M"],
        "hybrid_128m": ["--method", "hybrid", "--stream", "--max-memory", "128M"]}
SAME = ("stream", "stream_128m", "ranks")  # as "memory"
PEERS = ("vtk_memory", "vtk_pieces", "vtk_slabs", "skimage")
WAYS = (*OURS, "ranks", *PEERS, "paraview")
AS_ROOT = {"OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}
MPIRUN = ["mpirun", "--oversubscribe", "-np", str(RANKS)]


def has_modules(python, *modules):
    return shutil.which(python) and subprocess.run([python, "-c", "import " + ", ".join(modules)], check=False,
                                                   stderr=subprocess.DEVNULL).returncode == 0


class Volume:
    """A raw cube in a folder, and the commands that make its surface there."""

    def __init__(self, arguments, folder, field, side):
        self.folder, self.field, self.side = folder, field, side
        self.path = os.path.join(folder, "volume.raw")
        self.tool = os.path.join(arguments.build, "host", "tool", "tetracubes")
        self.mpi = os.path.join(arguments.build, "host", "mpi", "tetracubes-mpi")
        self.python = arguments.python
        self.dims = ",".join([str(side)] * 3)
        process.run([self.tool, "generate", field, "--dims", self.dims, "--type", "u8", "-o", self.path, "--quiet"])

    def ours(self, program, way, more):
        return [*program, "extract", self.path, "--dims", self.dims, "--type", "u8", "--iso", ISO, "-o", self.made(way),
                "--json", *more]

    def theirs(self, program, way):
        return [*program, os.path.join(HERE, "out_of_core_peers.py"), way, self.path, str(self.side), ISO,
                self.made(way), str(PIECES)]

    def made(self, way):
        """The file of a way."""
        return os.path.join(self.folder, way + (".pvtp" if way == "paraview" else ".vtp"))

    def commands(self):
        commands = {way: self.ours([self.tool], way, more) for way, more in OURS.items()}
        if os.path.exists(self.mpi) and shutil.which("mpirun"):
            commands["ranks"] = self.ours([*MPIRUN, self.mpi], "ranks", [])
        if has_modules(self.python, "vtkmodules", "skimage"):
            commands.update({way: self.theirs([self.python], way) for way in PEERS})
        if shutil.which("pvbatch") and shutil.which("mpirun"):
            commands["paraview"] = self.theirs([*MPIRUN, "pvbatch"], "paraview")
        return commands

    def bytes_made(self, way):
        """Those of a way's files, which are removed then but for the first one."""
        names = [name for name in os.listdir(self.folder) if name.startswith(way + ".") or name == way]
        paths = [os.path.join(self.folder, name) for name in names]
        paths += [os.path.join(path, name) for path in paths if os.path.isdir(path) for name in os.listdir(path)]
        size = sum(os.path.getsize(path) for path in paths if os.path.isfile(path))
        for path in filter(os.path.isdir, paths):
            shutil.rmtree(path)
        if way != "memory":
            for path in filter(os.path.isfile, paths):
                os.remove(path)
        return size


def told(way, done):
    """What the process tells: time, and what is in its file."""
    if way in OURS or way == "ranks":
        surface = json.loads(done.text)["surfaces"][0]
        return {"ms": 1e3 * done.seconds, "cpu_ms": 1e3 * done.cpu_seconds, "vertices": surface["vertices"],
                "triangles": surface["triangles"]}
    return {"cpu_ms": 1e3 * done.cpu_seconds, **json.loads(done.text.splitlines()[-1])}


def turn(volume, way, command):
    done = process.run(command, env=dict(os.environ, **AS_ROOT))
    result = {**told(way, done), "peak": done.peak}
    if way in SAME and not filecmp.cmp(volume.made(way), volume.made("memory"), shallow=False):
        raise process.Failure(f"{volume.field} {volume.side}^3: {way} makes another file")
    result["bytes"] = volume.bytes_made(way)
    return result


def middle(values):
    return {"median": round(statistics.median(values), 1), "min": round(min(values), 1), "max": round(max(values), 1)}


def case(arguments, folder, field, side):
    volume = Volume(arguments, folder, field, side)
    commands = {way: command for way, command in volume.commands().items() if way in arguments.ways or way == "memory"}
    turns = {way: [] for way in commands}
    first = {way: turn(volume, way, command) for way, command in commands.items()}  # kernels and pages are there then
    for number in range(arguments.repeat):
        for way in ["memory", *list(commands)[1:][::-1 if number % 2 else 1]]:
            if not number or first[way]["ms"] < SLOW_MS:
                turns[way].append(turn(volume, way, commands[way]))
    result = {"field": field, "side": side, "ways": {}}
    for way, all_turns in turns.items():
        last = all_turns[-1]
        result["ways"][way] = {"ms": middle([one["ms"] for one in all_turns]),
                               "cpu_ms": middle([one["cpu_ms"] for one in all_turns]),
                               "peak_mb": round(max(one["peak"] for one in all_turns) / 1e6, 1),
                               "vertices": last["vertices"], "triangles": last["triangles"],
                               "file_mb": round(last["bytes"] / 1e6, 1), "turns": len(all_turns)}
        print(f"{field} {side}^3 {way:<12} {result['ways'][way]['ms']['median']:10.1f} ms, "
              f"{result['ways'][way]['cpu_ms']['median']:10.1f} ms of processors, peak "
              f"{result['ways'][way]['peak_mb']:8.1f} MB, {last['triangles']:,} triangles", flush=True)
    for name in os.listdir(folder):
        os.remove(os.path.join(folder, name))
    return result


def versions(python):
    """Of those that are there."""
    told = {}
    for name, command in (("VTK", [python, "-c", "import vtk; print(vtk.VTK_VERSION)"]),
                          ("scikit-image", [python, "-c", "import skimage; print(skimage.__version__)"]),
                          ("ParaView", ["pvbatch", "--version"])):
        done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True, check=False) \
            if shutil.which(command[0]) else None
        if done and done.returncode == 0:
            told[name] = done.stdout.split()[-1]
    return told


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", required=True, metavar="DIR", help="the build folder, of a Release")
    parser.add_argument("--python", default=os.path.join(HERE, "..", "build-peers", "bin", "python3"), metavar="FILE",
                        help="the Python that has the others, default build-peers/bin/python3")
    parser.add_argument("--folder", metavar="DIR", help="where files go: 10 GB of room (default: that for temporary ones)")
    parser.add_argument("--sizes", nargs="+", type=int, default=[512, 1024], metavar="N", help="samples along an axis")
    parser.add_argument("--fields", nargs="+", default=["sphere", "gyroid"])
    parser.add_argument("--ways", nargs="+", default=WAYS, choices=WAYS, metavar="WAY", help=f"of {', '.join(WAYS)}")
    parser.add_argument("--repeat", type=int, default=5, metavar="R", help="turns of each, default 5; of slow ones 1")
    parser.add_argument("--results", metavar="DIR", help="write the results there, as bench/results/out_of_core")
    arguments = parser.parse_args()
    load = [round(os.getloadavg()[0], 2)]
    with tempfile.TemporaryDirectory(prefix="tetracubes-out-of-core-", dir=arguments.folder) as folder:
        cases = [case(arguments, folder, field, side) for side in arguments.sizes for field in arguments.fields]
    load.append(round(os.getloadavg()[0], 2))
    if arguments.results:
        cpu = collect.cpu_model()
        result = {"date": datetime.date.today().isoformat(), "cpu": cpu, "cores": len(os.sched_getaffinity(0)),
                  "load_before_and_after": load, "pieces": PIECES, "ranks": RANKS, "versions": versions(arguments.python),
                  "cases": cases}
        os.makedirs(arguments.results, exist_ok=True)
        with open(os.path.join(arguments.results, collect.file_name(cpu, "") + ".json"), "w", encoding="utf-8") as file:
            json.dump(result, file, indent=1)
            file.write("\n")


if __name__ == "__main__":
    try:
        main()
    except process.Failure as failure:
        sys.exit(f"out_of_core.py: {failure}")
