#!/usr/bin/env python3
"""Static and dynamic analysis of all that runs on the host.

    hygiene.py SOURCE BUILD [STAGE...] [--base COMMIT]

format       clang-format 14 would change no file of C
clang        clang compiles everything without a warning
changed      clang-tidy over the files of host/ that differ from COMMIT, and over those that include them
warnings     gcc and clang compile everything without a warning
tidy         clang-tidy over host/, with the checks of .clang-tidy
cppcheck     over host/, with the suppressions of cppcheck.txt
readers      readers, writers, reference and public functions under the address and undefined-behaviour sanitizers
sanitizers   all tests under them
failed       those of them that failed the last time
threads      a context per thread under the thread sanitizer, the library's own threads included
valgrind     memcheck over tests without a device, and over the tool with the reference engine

Without a stage: warnings to valgrind, but for readers and failed, which are parts of sanitizers. Builds go to
BUILD/hygiene, where they are kept; BUILD is a finished build, whose compile commands, tool and cache of kernels are
used; the first three stages need none. Prints what was found, and writes hygiene.json where TETRACUBES_RESULTS
names a folder; failed, alone, renews its figure there. Exit status 77: a program that a stage needs is not installed.
"""
import argparse
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

from results import Part, run, tool_version

FILE_TESTS = ["test_read", "test_read_lenient", "test_nrrd_lenient", "test_read_hostile", "test_vtk_legacy",
              "test_vtk_legacy_odd", "test_vtk_legacy_hostile", "test_vtk_xml", "test_vtk_xml_hostile", "test_plot3d",
              "test_dataset", "test_write", "test_write_vtk", "test_write_vtk_wide"]
QUICK_TESTS = ["test_read_lenient", "test_nrrd_lenient", "test_read_hostile", "test_vtk_xml", "test_vtk_xml_hostile",
               "test_dataset", "test_write_vtk", "test_misuse", "test_order", "test_api"]
SANITIZED = "address,undefined"
LEAKS = {"ASAN_OPTIONS": "detect_leaks=1:detect_stack_use_after_return=1:use_sigaltstack=0",
         "LSAN_OPTIONS": f"suppressions='{Path(__file__).resolve().parent / 'leaks.txt'}':print_suppressions=0",
         "UBSAN_OPTIONS": "print_stacktrace=1"}  # use_sigaltstack: PoCL's threads have stacks of their own for signals
FORMAT_VERSION = "14"
FORMATTED = ["bench", "host", "kernels", "tests"]
FAULTS = r"(?:AddressSanitizer|LeakSanitizer|ThreadSanitizer)|runtime error:"


class Hygiene:
    """The stages; each returns the number of faults, having printed them."""

    def __init__(self, arguments, part):
        self.source, self.build, self.base, self.part = arguments.source, arguments.build, arguments.base, part
        self.work = self.build / "hygiene"
        self.jobs = str(len(os.sched_getaffinity(0)))
        self.no_device = tempfile.mkdtemp(prefix="tetracubes-no-vendors-")

    def configure(self, name, *options, compiler="gcc"):
        folder = self.work / name
        run(["cmake", "-S", self.source, "-B", folder, "-G", "Ninja", f"-DCMAKE_C_COMPILER={compiler}", *options])
        return folder

    def compile(self, folder, targets=()):
        """The compiler's output; None where it fails."""
        command = ["cmake", "--build", folder, "--parallel", self.jobs]
        for target in targets:
            command += ["--target", target]
        return run(command, check=False)

    def environment(self, device=False, **more):
        """Of a test program: no caches of the user's; without a device unless asked for."""
        values = {**os.environ, "TETRACUBES_CACHE_DIR": "", **more}
        if not device:
            values["OCL_ICD_VENDORS"] = self.no_device
        return values

    def run_tests(self, folder, names, wrapper=(), device=False, arguments=(), **variables):
        """Faults of the programs, one by one; 77 is a test that had no device: right where it is to run without one."""
        faults = 0
        for name in names:
            program = next(folder.glob(f"tests/**/{name}"))
            done = run([*wrapper, program, *arguments], check=False, env=self.environment(device, **variables))
            if done.returncode not in ((0,) if device else (0, 77)) or re.search(FAULTS, done.stdout):
                print(f"{name}: exit status {done.returncode}\n{done.stdout[-4000:]}")
                faults += 1
        return faults

    # ------------------------------------------------------------------------------------------------------ static

    def format(self):
        files = [path for folder in FORMATTED for path in sorted((self.source / folder).rglob("*"))
                 if path.suffix in (".c", ".h", ".inc", ".cl")]
        done = run([clang_format(), "--dry-run", "--Werror", *files], check=False)
        found = sorted(set(re.findall(r"^(.*?):\d+:\d+: error: ", done.stdout, re.MULTILINE)))
        for path in found:
            print(f"clang-format -i {path}")
        return len(found) + (done.returncode != 0 and not found)

    def clang(self):
        return self.warnings(("clang",))

    def warnings(self, compilers=("gcc", "clang")):
        count = 0
        for compiler in compilers:
            folder = self.configure(f"warnings-{compiler}", "-DCMAKE_BUILD_TYPE=Release", compiler=compiler)
            self.compile(folder, ["clean"])
            done = self.compile(folder)
            found = re.findall(r"^.*(?:warning|error):.*$", done.stdout, re.MULTILINE)
            print("\n".join(found))
            count += len(found) + (done.returncode != 0 and not found)
        self.part.figure(f"compiler warnings, {' and '.join(compilers)}", count)
        return count

    def changed_sources(self):
        """The sources of host/ that differ from the base, with those that include a header that does."""
        git = ["git", "-C", self.source]
        bases = [self.base, run([*git, "merge-base", "HEAD", "origin/HEAD"], check=False).stdout.strip(), "HEAD~1"]
        base = next(name for name in bases if name and not run([*git, "cat-file", "-e", f"{name}^{{commit}}"],
                                                               check=False).returncode)
        names = run([*git, "diff", "--name-only", "--diff-filter=d", base, "--", "host"]).stdout.split()
        headers = {Path(name).name for name in names if Path(name).suffix in (".h", ".inc")}
        includes = re.compile(r'^#include "(?:.*/)?(.*)"$', re.MULTILINE)
        sources = {path for path in (self.source / "host").rglob("*.c")
                   if headers & set(includes.findall(path.read_text(encoding="utf-8")))}
        sources |= {self.source / name for name in names if name.endswith(".c")}
        print(f"{len(sources)} sources differ from {base}, or include what does")
        return sorted(sources)

    def changed(self):
        sources = self.changed_sources()
        return self.tidy(f"^(?:{'|'.join(re.escape(str(path)) for path in sources)})$") if sources else 0

    def tidy(self, files=None):
        folder = self.configure("warnings-clang", "-DCMAKE_BUILD_TYPE=Release", compiler="clang")
        self.compile(folder)
        tidy = shutil.which("run-clang-tidy") or shutil.which("run-clang-tidy-14")
        done = run([tidy, "-p", folder, "-j", self.jobs, "-quiet", files or f"^{re.escape(str(self.source))}/host/.*"],
                   check=False)
        text = re.sub(r"\x1b\[[0-9;]*m", "", done.stdout)
        found = sorted(set(re.findall(r"^.*(?:warning|error):.*$", text, re.MULTILINE)))
        print("\n".join(found))
        self.part.figure("clang-tidy findings", len(found))
        return len(found) + (done.returncode != 0 and not found)

    def cppcheck(self):
        commands = json.loads((self.build / "compile_commands.json").read_text(encoding="utf-8"))
        own = [entry for entry in commands if entry["file"].startswith(f"{self.source}/host/")]
        with tempfile.TemporaryDirectory(prefix="tetracubes-cppcheck-") as folder:
            project = Path(folder) / "compile_commands.json"
            project.write_text(json.dumps(own), encoding="utf-8")
            suppressions = self.source / "tests" / "hygiene" / "cppcheck.txt"
            done = run(["cppcheck", f"--project={project}", "--enable=warning,performance,portability", "--quiet",
                        "-j", self.jobs, f"--suppressions-list={suppressions}", "--error-exitcode=1",
                        "--template={file}:{line}: {severity}: {id}: {message}"], check=False)
        found = sorted(set(re.findall(r"^.*: (?:error|warning|performance|portability): .*$", done.stdout, re.MULTILINE)))
        print("\n".join(found) if found else done.stdout)
        self.part.figure("cppcheck findings", len(found))
        return len(found) + (done.returncode != 0 and not found)

    # ----------------------------------------------------------------------------------------------------- dynamic

    def sanitized(self, name, kinds, targets):
        folder = self.configure(name, "-DCMAKE_BUILD_TYPE=Debug", "-DCMAKE_C_FLAGS=-O1", "-DTETRACUBES_BENCH=OFF",
                                f"-DTETRACUBES_SANITIZE={kinds}")
        done = self.compile(folder, targets)
        if done.returncode:
            raise RuntimeError(done.stdout[-4000:])
        return folder

    def readers(self):
        names = QUICK_TESTS
        strict = {**LEAKS, "ASAN_OPTIONS": LEAKS["ASAN_OPTIONS"] + ":strict_string_checks=1"}  # slow
        return self.run_tests(self.sanitized("sanitizers", SANITIZED, names), names, **strict)

    def sanitizers(self):
        done = self.tests_sanitized()
        ran = re.search(r"tests failed out of (\d+)", done.stdout)
        self.part.figure("tests under address and undefined-behaviour sanitizers", int(ran[1]) if ran else 0)
        return self.judge_sanitized(done) + (ran is None)

    def failed(self):
        return self.judge_sanitized(self.tests_sanitized("--rerun-failed"))

    def tests_sanitized(self, *more):
        """The whole ctest but for what preloads a library, with the kernels that the build at hand has compiled."""
        folder = self.sanitized("sanitizers", SANITIZED, [])
        for part in (self.build / "tests" / "kernel_pool").glob("*"):
            shutil.copytree(part, folder / "tests" / "kernel_pool" / part.name, dirs_exist_ok=True)
        plain = {name: value for name, value in os.environ.items() if name != "TETRACUBES_RESULTS"}  # of a sample, here
        return run(["ctest", "--test-dir", folder, "--output-on-failure", "-j", self.jobs, "--timeout", "1800", *more,
                    "-E", "^(test_install|test_readme|test_sanitized|test_static|test_data|test_endings)$"], check=False,
                   env={**plain, **LEAKS})

    def judge_sanitized(self, done):
        failed = re.findall(r"^\s+\d+ - \w+ \(\w+\)$", done.stdout, re.MULTILINE)
        faults = len(re.findall(FAULTS, done.stdout))
        if failed or faults or done.returncode:
            print(done.stdout[-20000:])
        self.part.figure("faults that these sanitizers found", len(failed))
        return len(failed) + faults + (done.returncode != 0 and not failed)

    def threads(self):
        folder = self.sanitized("threads", "thread", ["test_threads", "test_contexts", "test_tetrahedralize", "test_order"])
        with tempfile.TemporaryDirectory(prefix="tetracubes-kernels-") as cache:
            options = {"TSAN_OPTIONS": "halt_on_error=0", "POCL_CACHE_DIR": cache}
            faults = self.run_tests(folder, ["test_tetrahedralize", "test_order"], **options)
            faults += self.run_tests(folder, ["test_threads"], arguments=["4"], **options)
            faults += self.run_tests(folder, ["test_threads", "test_contexts"], device=True, **options)
        self.part.figure("data races found", faults)
        return faults

    def valgrind(self):
        folder = self.configure("valgrind", "-DCMAKE_BUILD_TYPE=Debug", "-DCMAKE_C_FLAGS=-O1", "-DTETRACUBES_BENCH=OFF")
        self.compile(folder)
        checker = ["valgrind", "--quiet", "--error-exitcode=99", "--leak-check=full",
                   "--errors-for-leak-kinds=definite,indirect,possible", "--track-fds=no"]
        names = [*FILE_TESTS, "test_inside", "test_cancel", "test_order", "test_threads", "test_misuse"]
        faults = self.run_tests(folder, names, wrapper=checker)
        runs = 0
        with tempfile.TemporaryDirectory(prefix="tetracubes-valgrind-") as here:
            for command in tool_commands():
                done = run([*checker, folder / "host" / "tool" / "tetracubes", *command.split()], check=False, cwd=here,
                           env=self.environment())
                runs += 1
                if done.returncode:
                    print(f"tetracubes {command}: exit status {done.returncode}\n{done.stdout[-4000:]}")
                    faults += 1
        self.part.figure("programs run under valgrind", len(names) + runs)
        self.part.figure("faults that valgrind found", faults)
        return faults


def tool_commands():
    """Small runs of the tool by the reference: every type, kind of grid, output format and command."""
    commands = []
    for sample in ("u8", "i8", "u16", "i16", "u32", "i32", "f32", "f64"):
        commands.append(f"generate gyroid --dims 21,18,15 --type {sample} -o {sample}.nrrd")
        commands.append(f"extract {sample}.nrrd --iso 99.5 --engine reference --check --json -o {sample}.ply")
    extract = "extract f32.nrrd --iso 99.5,127.5 --engine reference"
    commands += [f"{extract} -o %.{ending}" for ending in ("ply", "stl", "obj", "vtp", "off", "glb", "html", "npz")]
    commands += [f"{extract} --method hybrid --normals --check", f"{extract} --soup -o %.stl", f"{extract} --count",
                 f"{extract} --nodata 0 --check", "info f32.nrrd --json", "tetrahedralize f32.nrrd -o cells.vtu",
                 "isovolume f32.nrrd --range 90,120 --engine reference --check -o part.vtu",
                 "isovolume cells.vtu --range ,100 --range 100, --engine reference --json",
                 "info cells.vtu", "extract cells.vtu --iso 99.5 --engine reference --check -o cells.vtp", "--version"]
    return commands


def clang_format():
    """The one whose style the tree has: other versions lay some lines out in another way. None: it is not installed."""
    for name in (f"clang-format-{FORMAT_VERSION}", "clang-format"):
        if shutil.which(name) and tool_version(name)[1].split(".")[0] == FORMAT_VERSION:
            return name
    return None


NEEDS = {"clang": ["clang"], "changed": ["clang", "clang-tidy", "git"], "warnings": ["clang"],
         "tidy": ["clang", "clang-tidy"], "cppcheck": ["cppcheck"], "valgrind": ["valgrind"]}
ALL = ["warnings", "tidy", "cppcheck", "sanitizers", "threads", "valgrind"]


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("source", type=Path)
    parser.add_argument("build", type=Path)
    parser.add_argument("stages", nargs="*", default=ALL)
    parser.add_argument("--base", metavar="COMMIT", help="of stage changed; default: where origin's branch was "
                                                         "left, or the commit before this one")
    arguments = parser.parse_args()
    arguments.source, arguments.build = arguments.source.resolve(), arguments.build.resolve()
    missing = {name for stage in arguments.stages for name in NEEDS.get(stage, []) if not shutil.which(name)}
    if "format" in arguments.stages and not clang_format():
        missing.add(f"clang-format {FORMAT_VERSION}")
    if missing:
        print(f"skipped: not installed: {', '.join(sorted(missing))}")
        return 77
    part = Part("hygiene", [tool_version(name) for name in ("gcc", "clang", "cppcheck", "valgrind")])
    hygiene = Hygiene(arguments, part)
    faults = 0
    for stage in arguments.stages:
        found = getattr(hygiene, stage)()
        print(f"{stage}: {found} faults", flush=True)
        faults += found
    os.rmdir(hygiene.no_device)
    if set(ALL) <= set(arguments.stages):
        part.write()
    elif arguments.stages == ["failed"]:
        part.renew()
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
