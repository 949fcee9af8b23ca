#!/usr/bin/env python3
"""mutants.py - negative controls: faults are planted in a copy of the tree, and every one has to be caught by a test

Usage: mutants.py SOURCE WORK [--only WORD]... [--sample] [--workers N] [--list]

SOURCE is never changed: each of N workers has a copy of it and a build folder under WORK, which a later run uses again.
The mutants of table.py and entries.py are planted one at a time, what the next test needs is built, and tests are run,
the cheapest first, until one fails; before it is used for the first time, each has to pass without a fault. A crash is a
failure, and so is more processor time than ten times what the test needs otherwise and three seconds, or 24 GiB of
files in the folder where it may write, which is removed after each.

A mutant that no test catches is an error, unless the table says why it is the same program; one that the table calls
the same and that is caught is an error too, and so is one whose text is not in the source any more or does not compile.
--only keeps the mutants whose file, text, description or point has one of the words; --sample a few of every kind;
--changed those whose file is not as it was when mutants.json was written. What this processor would not compile is left
out.

Prints one line per mutant. Where TETRACUBES_RESULTS names a folder, mutants.json there tells the same, and keeps what it
told of other mutants whose files are as they were.
"""
import argparse
import collections
import datetime
import hashlib
import json
import os
import queue
import re
import resource
import shutil
import signal
import subprocess
import sys
import threading
import time

import entries
import table
from table import TableError

COPIED = ("host", "kernels", "tests", "CMakeLists.txt")
CONFIGURE = ["-G", "Ninja", "-DCMAKE_BUILD_TYPE=None", "-DCMAKE_C_FLAGS=-O1", "-DTETRACUBES_BENCH=OFF"]
MEMORY_MOST = 16 << 30
FILE_MOST = 16 << 30  # a writer without its limits fills the disk,
DISK_MOST = 24 << 30   # be it with several files: so much in a test's folder, and it is stopped
# Built in a fifth of the time; what they compute is the same. PoCL 6.0 aborts on them.
QUICK_KERNELS = "-cl-opt-disable" if table.versions().get("PoCL", "").startswith("3.") else ""
KERNELS_REFUSED = "does not build the kernels"  # as host/lib/opencl/program.c says it
SKIPPED = 77  # what a test says of its part for a device
Result = collections.namedtuple("Result", "mutant line verdict test seconds")


def planted(text, mutant):
    """The text of the file with the mutant in it, and the line where it is."""
    found = [m.start() for m in re.finditer(re.escape(mutant.old), text)]
    if mutant.at is not None and text.startswith(mutant.old, mutant.at):
        at = mutant.at
    elif mutant.nth is None and len(found) == 1:
        at = found[0]
    elif mutant.nth is not None and mutant.nth < len(found):
        at = found[mutant.nth]
    else:
        raise TableError(f"{mutant.file}: {len(found)} times in the source: {mutant.old!r}")
    return text[:at] + mutant.new + text[at + len(mutant.old):], text.count("\n", 0, at) + 1


def targets_of(test):
    """What has to be built for it."""
    if test.program.endswith(".py"):
        return ["tetracubes_tool", *(re.split("[/=]", name)[-1] for name in test.libraries)]
    return [os.path.basename(test.program)] + (["layer"] if is_layered(test) else [])


def is_layered(test):
    return test.program.startswith("layer/")


def write_text(path, text):
    with open(path, "w", encoding="utf-8") as f:
        f.write(text)


def write_if_changed(path, content):
    try:
        with open(path, "rb") as f:
            if f.read() == content:
                return
    except FileNotFoundError:
        os.makedirs(os.path.dirname(path), exist_ok=True)
    with open(path, "wb") as f:
        f.write(content)


def files_below(folder):
    for name in COPIED:
        path = os.path.join(folder, name)
        if os.path.isfile(path):
            yield name
        for parent, _, files in os.walk(path):
            for file in files:
                yield os.path.relpath(os.path.join(parent, file), folder)


def bytes_below(folder):
    """What the files of the folder take of the disk."""
    total = 0
    for place, _, files in os.walk(folder):
        for name in files:
            try:
                total += 512 * os.lstat(os.path.join(place, name)).st_blocks
            except FileNotFoundError:  # removed meanwhile
                pass
    return total


class Worker:
    """A copy of the tree with a build folder of its own."""

    def __init__(self, source, work, number, jobs):
        self.jobs = jobs
        self.folder = os.path.join(work, str(number))
        self.source = os.path.join(self.folder, "source")
        self.build_folder = os.path.join(self.folder, "build")
        self.scratch = os.path.join(self.folder, "scratch")  # where a test may write
        self.usual = {}  # test -> processor time without a fault
        self.copy(source)
        if not os.path.exists(os.path.join(self.build_folder, "build.ninja")):
            self.must(["cmake", "-S", self.source, "-B", self.build_folder] + CONFIGURE)

    def copy(self, source):
        wanted = set(files_below(source))
        for name in wanted:
            with open(os.path.join(source, name), "rb") as f:
                write_if_changed(os.path.join(self.source, name), f.read())
        for name in set(files_below(self.source)) - wanted:
            os.unlink(os.path.join(self.source, name))

    def must(self, command):
        done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        if done.returncode:
            raise TableError(f"{' '.join(command)}:\n{done.stdout[-3000:]}")

    def build(self, targets):
        self.must(["cmake", "--build", self.build_folder, f"-j{self.jobs}", "--target", *targets])

    def builds(self, targets):
        try:
            self.build(targets)
            return True
        except TableError:
            return False

    def cache(self, name):
        """Kernels of a mutant are never found in another's cache; those of tests of mutants of the host are kept."""
        path = os.path.join(self.folder, "cache-" + name)
        if name != "kept":
            shutil.rmtree(path, ignore_errors=True)
        os.makedirs(path, exist_ok=True)
        return path

    def wait(self, child, seconds):
        """Its exit status; it is killed after so many seconds, or when it has written too much."""
        end = time.monotonic() + seconds
        while time.monotonic() < end and bytes_below(self.scratch) <= DISK_MOST:
            try:
                return child.wait(timeout=0.5)
            except subprocess.TimeoutExpired:
                pass
        os.killpg(child.pid, signal.SIGKILL)  # and those that it has started
        return child.wait()

    def library(self, name):
        """Of "layer/layer" its path, of "fault=mesh_fault" the same behind that word."""
        word, equals, path = name.rpartition("=")
        folder, own = os.path.split(path)
        return word + equals + os.path.join(self.build_folder, "tests", folder, f"lib{own}.so")

    def run(self, test, cache, processor_seconds):
        """Whether the test passes, the processor time that it took, and what it said."""
        environment = dict(os.environ, TETRACUBES_CACHE_DIR="", POCL_CACHE_DIR=cache, TEST_ONLY=test.only,
                           TEST_STOP="1", POCL_EXTRA_BUILD_FLAGS=QUICK_KERNELS, TMPDIR=self.scratch)
        if not test.device:
            environment["OCL_ICD_VENDORS"] = os.devnull
        if is_layered(test):
            environment["OPENCL_LAYERS"] = self.library("layer/layer")
        command = [os.path.join(self.build_folder, "tests", test.program), *test.arguments]
        if test.program.endswith(".py"):
            tool = os.path.join(self.build_folder, "host", "tool", "tetracubes")
            command = [sys.executable, os.path.join(self.source, "tests", test.program), tool,
                       *map(self.library, test.libraries), *test.arguments]

        def limit():
            resource.setrlimit(resource.RLIMIT_CPU, (processor_seconds, processor_seconds + 1))
            resource.setrlimit(resource.RLIMIT_AS, (MEMORY_MOST, MEMORY_MOST))
            resource.setrlimit(resource.RLIMIT_FSIZE, (FILE_MOST, FILE_MOST))
            resource.setrlimit(resource.RLIMIT_CORE, (0, 0))

        os.makedirs(self.scratch, exist_ok=True)
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        said = os.path.join(self.folder, "output.log")
        with open(said, "wb") as output, subprocess.Popen(command, env=environment, cwd=self.folder, preexec_fn=limit,
                                                          stdout=output, stderr=output,
                                                          start_new_session=True) as child:
            status = self.wait(child, 60 + 10 * processor_seconds)
        shutil.rmtree(self.scratch, ignore_errors=True)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        passed = status == 0 or (status == SKIPPED and not test.device)
        with open(said, encoding="utf-8", errors="replace") as output:
            return passed, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime, output.read(1 << 16)

    def check_without_fault(self, name):
        """The test passes, once: that run builds its kernels, as that of a mutated kernel has to."""
        if name in self.usual:
            return
        self.build(targets_of(table.TESTS[name]))
        passed, self.usual[name], said = self.run(table.TESTS[name], self.cache("first"), 3600)
        if not passed:
            raise TableError(f"{name} fails without a fault, in {self.folder}: {said[-2000:]}")

    def plant(self, mutant):
        """The mutant's fate: a Result."""
        path = os.path.join(self.source, mutant.file)
        with open(path, encoding="utf-8") as f:
            text = f.read()
        changed, line = planted(text, mutant)
        start = time.monotonic()
        caught, compiles = None, True
        is_kernel = mutant.file.startswith("kernels/")
        cache = self.cache("mutant" if is_kernel else "kept")
        for name in table.tests_of(mutant):
            self.check_without_fault(name)
            test = table.TESTS[name]
            try:
                write_text(path, changed)
                compiles = self.builds(targets_of(test))
                passed, _, said = self.run(test, cache, int(10 * self.usual[name]) + 3) if compiles else (False, 0, "")
                compiles = compiles and not (is_kernel and KERNELS_REFUSED in said)
            finally:
                write_text(path, text)
            if not passed:
                caught = name
                break
        if not compiles:
            verdict = "DOES NOT COMPILE"
        elif mutant.same:
            verdict = "wrongly called the same" if caught else "the same"
        else:
            verdict = "caught" if caught else "SURVIVED"
        return Result(mutant, line, verdict, caught, time.monotonic() - start)


def all_mutants(source):
    mutants = list(table.MUTANTS)
    for file, tables in entries.TABLES.items():
        with open(os.path.join(source, file), encoding="utf-8") as f:
            mutants += entries.mutants(file, f.read(), tables)
    return mutants


def check_table(source, mutants):
    faults = []
    for mutant in mutants:
        try:
            with open(os.path.join(source, mutant.file), encoding="utf-8") as f:
                planted(f.read(), mutant)
            table.tests_of(mutant)
        except TableError as e:
            faults.append(str(e))
    if faults:
        raise TableError("\n".join(faults))


def result_line(r):
    why = r.test or r.mutant.same or ""
    return f"{r.mutant.file}:{r.line}: {r.mutant.what}: {r.verdict}{': ' if why else ''}{why} ({r.seconds:.1f} s)"


def run_all(source, work, mutants, worker_count):
    results, errors, waiting = [], [], queue.Queue()
    for mutant in mutants:
        waiting.put(mutant)

    def work_through(number):
        try:
            worker = Worker(source, work, number, 2 if worker_count == 1 else 1)
            while not errors:
                r = worker.plant(waiting.get_nowait())
                results.append(r)
                print(result_line(r), flush=True)
        except queue.Empty:
            pass
        except TableError as e:
            errors.append(e)

    threads = [threading.Thread(target=work_through, args=(n,)) for n in range(worker_count)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    if errors:
        sys.exit(f"mutants.py: {errors[0]}")
    return results


def sums(source, mutants):
    """What tells a file's text from another, of the files that mutants are in."""
    found = {}
    for file in {m.file for m in mutants}:
        with open(os.path.join(source, file), "rb") as f:
            found[file] = hashlib.sha256(f.read()).hexdigest()[:16]
    return found


def told_before(folder, mutants, sum_of):
    """Lines of mutants.json that hold still: the mutant is in the table and was no fault, its file is as it was."""
    path = os.path.join(folder, "mutants.json")
    if not os.path.exists(path):
        return {}
    with open(path, encoding="utf-8") as f:
        lines = json.load(f)["mutants"]
    known = {(m.file, m.what) for m in mutants}
    return {(line["file"], line["what"]): line for line in lines
            if (line["file"], line["what"]) in known and line["sum"] == sum_of[line["file"]] and
            line["verdict"] in ("caught", "the same")}


def write_results(folder, results, before, sum_of, seconds):
    today = datetime.date.today().isoformat()
    lines = {**before, **{(r.mutant.file, r.mutant.what): {
        "file": r.mutant.file, "line": r.line, "what": r.mutant.what, "verdict": r.verdict, "test": r.test,
        "reason": r.mutant.same, "sum": sum_of[r.mutant.file], "date": today} for r in results}}
    lines = sorted(lines.values(), key=lambda line: (line["file"], line["line"], line["what"]))
    by = collections.Counter(line["verdict"] for line in lines)
    figures = [{"what": "faults planted in the sources", "value": len(lines)},
               {"what": "of these caught by a test", "value": by["caught"]},
               {"what": "of these the same program, with the reason", "value": by["the same"]},
               {"what": "of these neither", "value": len(lines) - by["caught"] - by["the same"]}]
    report = {"part": "mutants", "date": today, "versions": table.versions(), "seconds": round(seconds),
              "figures": figures, "mutants": lines}
    with open(os.path.join(folder, "mutants.json"), "w", encoding="utf-8") as f:
        json.dump(report, f, indent=1)
        f.write("\n")


def processor_features():
    """As /proc/cpuinfo names them, and one that names what AVX-512 makes unused."""
    with open("/proc/cpuinfo", encoding="utf-8") as f:
        features = set(re.search(r"(?m)^(?:flags|Features)\s*:(.*)$", f.read())[1].split())
    return features | {"avx2 without avx512bw"} if "avx2" in features and "avx512bw" not in features else features


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("source")
    parser.add_argument("work")
    parser.add_argument("--only", action="append", default=[])
    parser.add_argument("--sample", action="store_true")
    parser.add_argument("--changed", action="store_true")
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--list", action="store_true")
    arguments = parser.parse_args()
    mutants = all_mutants(arguments.source)
    try:
        check_table(arguments.source, mutants)
    except TableError as e:
        sys.exit(f"mutants.py: {e}")
    folder, sum_of = os.environ.get("TETRACUBES_RESULTS"), sums(arguments.source, mutants)
    before = told_before(folder, mutants, sum_of) if folder else {}
    features = processor_features()
    mutants = [m for m in mutants if not m.needs or m.needs in features]
    if arguments.changed:
        mutants = [m for m in mutants if (m.file, m.what) not in before]
    if arguments.only:
        mutants = [m for m in mutants if any(w in part for w in arguments.only
                                             for part in (m.file, m.what, m.old, m.point or ""))]
    if arguments.sample:
        mutants = [m for m in mutants if m.sample]
        arguments.workers = 1
    if arguments.list:
        for m in mutants:
            print(f"{m.file}: {m.what}: {m.old!r} -> {m.new!r}")
        print(f"{len(mutants)} mutants")
        return
    if not mutants:
        sys.exit("mutants.py: no mutant is of that kind")
    start = time.monotonic()
    results = run_all(os.path.abspath(arguments.source), os.path.abspath(arguments.work), mutants, arguments.workers)
    by = collections.Counter(r.verdict for r in results)
    print(f"{len(results)} mutants: " + ", ".join(f"{n} {verdict}" for verdict, n in sorted(by.items())))
    if folder:
        write_results(folder, results, before, sum_of, time.monotonic() - start)
    sys.exit(not results or bool(set(by) - {"caught", "the same"}))


if __name__ == "__main__":
    main()
