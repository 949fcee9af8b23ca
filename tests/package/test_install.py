#!/usr/bin/env python3
"""An installed library serves a stranger: pkg-config, CMake, C, C++, shared, static, and after the tree has moved.

    test_install.py SOURCE BUILD

The build at hand and a library-only build of the other kind (shared or static) are installed into temporary folders,
which are then renamed: nothing may depend on where they were. Small consumers are built against them and run with the
reference engine; the C example of host/include/README.md is another. The libraries must export the functions of their header and
nothing else. Manual pages and completions lie beside, where the build could make them.
"""
import argparse
import os
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

CONSUMER = r"""
#include <tetracubes.h>
#include <cstdio_or_stdio>
#include <string.h>

/* One corner of a cube inside: six edges leave it, four of the five tetrahedra have it. */
int main(void) {
    const unsigned char samples[8] = {255, 0, 0, 0, 0, 0, 0, 0};
    tc_context_options device;
    tc_grid_options volume;
    tc_extract_options how;
    tc_context *context = NULL;
    tc_grid *grid = NULL;
    tc_mesh *mesh = NULL;
    tc_mesh_data data;
    memset(&data, 0, sizeof data);
    data.struct_size = sizeof data;
    tc_context_options_init(&device);
    tc_grid_options_init(&volume);
    tc_extract_options_init(&how);
    device.engine = TC_ENGINE_REFERENCE;
    volume.dims[0] = volume.dims[1] = volume.dims[2] = 2;
    volume.type = TC_U8;
    volume.samples = samples;
    how.isovalue = 127.5;
    if (tc_context_create(&device, &context) || tc_grid_create(context, &volume, &grid) ||
        tc_extract(grid, &how, &mesh) || tc_mesh_get(mesh, &data))
        printf("%s\n", tc_message());
    else
        printf("%s %d %d\n", tc_version(), (int)data.vertex_count, (int)data.triangle_count);
    tc_mesh_destroy(mesh);
    tc_grid_destroy(grid);
    tc_context_destroy(context);
    return 0;
}
"""

PROJECT = """
cmake_minimum_required(VERSION 3.25)
project(consumer LANGUAGES {languages})
find_package(tetracubes {version} REQUIRED)
{executables}
"""

# A project that has the sources within itself: by add_subdirectory, and as FetchContent has it when it has fetched them.
PARENT = """
cmake_minimum_required(VERSION 3.25)
project(parent LANGUAGES C)
set(CMAKE_C_STANDARD 99)
enable_testing()
{include}
add_executable(consumer {source})
target_link_libraries(consumer PRIVATE tetracubes::tetracubes)
install(FILES {source} DESTINATION share)
set(settings "type=${{CMAKE_BUILD_TYPE}} shared=${{BUILD_SHARED_LIBS}} c=${{CMAKE_C_STANDARD}}")
file(GENERATE OUTPUT here.txt CONTENT "${{settings}} flags=$<TARGET_PROPERTY:consumer,COMPILE_OPTIONS>")
"""
INCLUDES = {
    "add_subdirectory": "add_subdirectory({source} tetracubes)",
    "FetchContent": "include(FetchContent)\nFetchContent_Declare(tetracubes SOURCE_DIR {source})\n"
                    "FetchContent_MakeAvailable(tetracubes)",
}

WARNINGS = ["-Wall", "-Wextra", "-Werror"]


class Failure(Exception):
    """A promise that does not hold."""


def run(*command, **more):
    """Standard output of a command that has to succeed."""
    command = [str(part) for part in command]
    done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False, **more)
    if done.returncode != 0:
        raise Failure(f"{' '.join(command)}: exit status {done.returncode}\n{done.stdout}")
    return done.stdout


def expect(condition, text):
    if not condition:
        raise Failure(text)


def only(paths, what):
    found = list(paths)
    expect(len(found) == 1, f"{what}: one expected, found {[str(path) for path in found]}")
    return found[0]


class Installation:
    """A prefix that was moved after the installation, and consumers built against it."""

    def __init__(self, arguments, build, folder, name):
        self.arguments = arguments
        self.folder = folder / f"{name} consumers"
        self.folder.mkdir()
        self.prefix = folder / f"{name}-moved"
        run(arguments.cmake, "--install", build, "--prefix", folder / name)
        (folder / name).rename(self.prefix)
        self.pc = only(self.prefix.rglob("tetracubes.pc"), "tetracubes.pc")
        self.libraries = self.pc.parent.parent
        self.is_shared = (self.libraries / "libtetracubes.so").exists()
        expect(self.is_shared != (self.libraries / "libtetracubes.a").exists(), f"{name}: shared or static, not both")

    def library(self):
        return self.libraries / ("libtetracubes.so" if self.is_shared else "libtetracubes.a")

    def expect_output(self, program, finds_library):
        """The consumer's line; a shared library is found by run path or, where there is none, by the environment."""
        environment = {name: value for name, value in os.environ.items() if name != "LD_LIBRARY_PATH"}
        if self.is_shared and not finds_library:
            environment["LD_LIBRARY_PATH"] = str(self.libraries)
        output = run(program, env=environment)
        wanted = f"{self.arguments.version} 6 4\n"
        expect(output == wanted, f"{program}: printed {output!r}, expected {wanted!r}")

    def compile(self, compiler, source, program):
        """Through pkg-config; the program's path."""
        environment = dict(os.environ, PKG_CONFIG_PATH=str(self.pc.parent))
        static = [] if self.is_shared else ["--static"]
        flags = run("pkg-config", *static, "--cflags", "--libs", "tetracubes", env=environment)
        run(compiler, *WARNINGS, source, "-o", self.folder / program, *shlex.split(flags))
        return self.folder / program

    def test_pkg_config(self, sources):
        environment = dict(os.environ, PKG_CONFIG_PATH=str(self.pc.parent))
        version = run("pkg-config", "--modversion", "tetracubes", env=environment).strip()
        expect(version == self.arguments.version, f"tetracubes.pc: version {version}")
        for compiler, source in sources:
            program = self.compile(compiler, source, f"by-pkg-config-{source.suffix[1:]}")
            self.expect_output(program, finds_library=False)

    def test_cmake(self, sources):
        executables = ""
        for _, source in sources:
            name = f"by-cmake-{source.suffix[1:]}"
            executables += f"add_executable({name} {source})\n"
            executables += f"target_link_libraries({name} PRIVATE tetracubes::tetracubes)\n"
        languages = " ".join("CXX" if source.suffix == ".cpp" else "C" for _, source in sources)
        version = ".".join(self.arguments.version.split(".")[:2])
        (self.folder / "CMakeLists.txt").write_text(
            PROJECT.format(languages=languages, version=version, executables=executables), encoding="utf-8")
        build = self.folder / "build"
        compilers = {"cpp": "CXX", "c": "C"}
        chosen = [f"-DCMAKE_{compilers[source.suffix[1:]]}_COMPILER={compiler}" for compiler, source in sources]
        run(self.arguments.cmake, "-S", self.folder, "-B", build, "-G", self.arguments.generator,
            f"-DCMAKE_PREFIX_PATH={self.prefix}", *chosen)
        run(self.arguments.cmake, "--build", build)
        for _, source in sources:
            self.expect_output(build / f"by-cmake-{source.suffix[1:]}", finds_library=True)

    def test_exports(self):
        """The symbols that a program can link are the header's functions, all of them and nothing else."""
        header = (self.prefix / "include" / "tetracubes.h").read_text(encoding="utf-8")
        declared = set(re.findall(r"^TC_API[^;(]*?\b(\w+)\(", header, re.MULTILINE))
        expect(len(declared) > 10, f"tetracubes.h: only {len(declared)} functions found")
        symbols = run("nm", "-D" if self.is_shared else "-g", "--defined-only", self.library())
        exported = set(re.findall(r"^[0-9a-f]+ \w (\w+)", symbols, re.MULTILINE))
        expect(exported == declared, f"{self.library()}: exported, but not in tetracubes.h: "
                                     f"{sorted(exported - declared)}; missing: {sorted(declared - exported)}")

    def test_tool(self):
        for name, wanted in [("tetracubes", f"tetracubes {self.arguments.version}\n"), ("tetracubes-bench", "")]:
            program = self.prefix / "bin" / name
            if not program.exists():
                print(f"{name}: not part of this build, skipped")
                continue
            environment = {key: value for key, value in os.environ.items() if key != "LD_LIBRARY_PATH"}
            output = run(program, "--help" if name.endswith("bench") else "--version", env=environment)
            expect(wanted in output, f"{program}: printed {output!r}")

    def test_manuals(self, programs):
        """A page for the library and for each program that is installed; groff finds nothing to say of them. They name
        every function of the header, and every option of the programs."""
        pages = {path.name: path for path in self.prefix.rglob("man/man*/*")}
        wanted = {"libtetracubes.3"} | {f"{name}.1" for name in programs}
        expect(pages.keys() == wanted, f"manual pages are {sorted(pages)}, wanted {sorted(wanted)}")
        texts = {name: path.read_text(encoding="utf-8").replace("\\-", "-") for name, path in pages.items()}
        header = (self.prefix / "include" / "tetracubes.h").read_text(encoding="utf-8")
        for word in re.findall(r"^TC_API[^;(]*?\b(\w+)\(|^} (\w+);", header, re.MULTILINE):
            expect("".join(word) in texts["libtetracubes.3"], f"libtetracubes.3 does not have {word}")
        helps = {name: [run(self.prefix / "bin" / name, "--help")] for name in programs if name != "tetracubes"}
        if programs:
            overview = run(self.prefix / "bin" / "tetracubes", "--help")
            commands = re.findall(r"^  tetracubes ([a-z]+) ", overview.split("\n\n")[1], re.MULTILINE)
            helps["tetracubes"] = [run(self.prefix / "bin" / "tetracubes", name, "--help") for name in commands]
        for name in programs:
            shown = re.findall(r"^\.TP\n\\fB(.*?)\\fR(?: \\fI(.*?)\\fR)?$", texts[f"{name}.1"], re.MULTILINE)
            lines = [line for text in helps[name] for line in re.findall(r"^  (-\S.*)$", text, re.MULTILINE)]
            expect(len(shown) == len(lines) > 10, f"{name}.1 has {len(shown)} options, --help {len(lines)}")
            for (option, value), line in zip(shown, lines):
                expect(f"{line} ".startswith(f"{option} {value}".rstrip() + " "), f"{name}.1: {option} {value}, {line}")
        for path in pages.values() if shutil.which("groff") else []:
            said = run("groff", "-man", "-ww", "-Tutf8", "-z", path)
            expect(not said, f"groff says of {path.name}: {said}")

    def test_completions(self):
        for name, first in ("bash-completion/completions/tetracubes", "# bash"), ("zsh/site-functions/_tetracubes",
                                                                               "#compdef tetracubes\n"):
            path = self.prefix / "share" / name
            expect(path.exists() and path.read_text(encoding="utf-8").startswith(first), f"{name} is not there")

    def test_readme(self, folder):
        """The C example of the library's page compiles without a warning, and writes what it says."""
        page = (self.arguments.source / "host" / "include" / "README.md").read_text(encoding="utf-8")
        example = only(re.findall(r"^```c\n(.*?)^```", page, re.MULTILINE | re.DOTALL), "host/include: C example")
        said = only(re.findall(r"^/\* prints: (.*) \*/$", example, re.MULTILINE), "host/include: 'prints:' comment")
        source = folder / "readme.c"
        source.write_text(example, encoding="utf-8")
        program = self.compile(self.arguments.cc, source, "readme")
        environment = dict(os.environ, LD_LIBRARY_PATH=str(self.libraries), POCL_CACHE_DIR=str(folder / "kernels"))
        (folder / "kernels").mkdir(exist_ok=True)
        output = run(program, env=environment)
        if "OpenCL" in output:
            print(f"example not compared: {output.strip()}")
            return
        expect(output == said + "\n", f"host/include: the C example prints {output!r}, it says {said!r}")


def cached(build, name):
    """Value of a variable of the build at hand."""
    cache = (build / "CMakeCache.txt").read_text(encoding="utf-8")
    return only(re.findall(rf"^{name}:\w+=(.*)$", cache, re.MULTILINE), f"{name} in CMakeCache.txt")


def build_other_kind(arguments, folder):
    """The library alone, static where the build at hand is shared and the other way round; not optimised, as what is
    tested is how it is linked."""
    is_shared = cached(arguments.build, "BUILD_SHARED_LIBS").upper() in ("ON", "1", "TRUE", "YES")
    build = folder / "other-build"
    parts = [f"-DTETRACUBES_{part}=OFF" for part in ("TOOL", "BENCH", "TESTS")]
    run(arguments.cmake, "-S", arguments.source, "-B", build, "-G", arguments.generator,
        f"-DCMAKE_C_COMPILER={arguments.cc}", "-DCMAKE_BUILD_TYPE=Debug",
        f"-DBUILD_SHARED_LIBS={'OFF' if is_shared else 'ON'}", *parts)
    run(arguments.cmake, "--build", build)
    return build


def test_within(arguments, folder, source, how, *options, shared=False):
    """The library within another project: it is there by its name, and leaves the other's settings, tests and installed
    files alone. Flags that change values do not reach it."""
    parent = folder / f"parent {how} {shared}"
    build = parent / "build"
    parent.mkdir()
    include = INCLUDES[how].format(source=f'"{arguments.source}"')
    text = PARENT.format(include=include, source=f'"{source}"')
    (parent / "CMakeLists.txt").write_text(text, encoding="utf-8")
    run(arguments.cmake, "-S", parent, "-B", build, "-G", arguments.generator, f"-DCMAKE_C_COMPILER={arguments.cc}",
        "-DCMAKE_C_FLAGS=-O0 -ffast-math", "-DCMAKE_EXPORT_COMPILE_COMMANDS=ON", *options)
    run(arguments.cmake, "--build", build)
    output = run(build / "consumer")
    expect(output == f"{arguments.version} 6 4\n", f"{how}: printed {output!r}")
    here = (build / "here.txt").read_text(encoding="utf-8")
    expect(here == f"type= shared={'ON' if shared else ''} c=99 flags=", f"{how}: the parent has {here!r}")
    cache = (build / "CMakeCache.txt").read_text(encoding="utf-8")
    expect("CMAKE_INSTALL_RPATH" not in cache, f"{how}: the parent's run paths are set")
    expect(("BUILD_SHARED_LIBS" in cache) == shared, f"{how}: BUILD_SHARED_LIBS is decided for the parent")
    tests = run("ctest", "--test-dir", build, "-N")
    expect("Total Tests: 0" in tests, f"{how}: tests among the parent's\n{tests}")
    commands = (build / "compile_commands.json").read_text(encoding="utf-8")
    expect(commands.count("-fno-fast-math") > 10 and "-Wall" not in commands, f"{how}: other flags")
    run(arguments.cmake, "--install", build, "--prefix", parent / "installed")
    installed = [path.name for path in (parent / "installed").rglob("*") if path.is_file()]
    expect(installed == [source.name], f"{how}: installed are {installed}")


def write_sources(arguments, folder):
    """[(compiler, source)]: C, and C++ where there is a compiler."""
    sources = [(arguments.cc, folder / "consumer.c")]
    sources[0][1].write_text(CONSUMER.replace("cstdio_or_stdio", "stdio.h"), encoding="utf-8")
    cxx = shutil.which("c++") or shutil.which("g++") or shutil.which("clang++")
    if cxx:
        sources.append((cxx, folder / "consumer.cpp"))
        sources[1][1].write_text(CONSUMER.replace("cstdio_or_stdio", "cstdio"), encoding="utf-8")
    else:
        print("no C++ compiler: C++ consumers skipped")
    return sources


def test(arguments, folder):
    sources = write_sources(arguments, folder)
    test_within(arguments, folder, sources[0][1], "add_subdirectory")
    test_within(arguments, folder, sources[0][1], "FetchContent", "-DBUILD_SHARED_LIBS=ON", shared=True)
    here = Installation(arguments, arguments.build, folder, "here")
    other = Installation(arguments, build_other_kind(arguments, folder), folder, "other")
    expect(here.is_shared != other.is_shared, "the two builds are of one kind")
    here.test_tool()
    programs = [name for name in ("tetracubes", "tetracubes-bench", "tetracubes-mpi") if (here.prefix / "bin" / name).exists()]
    here.test_manuals(programs)
    other.test_manuals([])
    if "tetracubes" in programs:
        here.test_completions()
    for installation in (here, other):
        installation.test_exports()
        installation.test_cmake(sources)
        if shutil.which("pkg-config"):
            installation.test_pkg_config(sources)
            installation.test_readme(folder)
        else:
            print("no pkg-config: consumers through it skipped")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("source", type=Path, help="folder of the sources")
    parser.add_argument("build", type=Path, help="folder of a finished build")
    arguments = parser.parse_args()
    arguments.source, arguments.build = arguments.source.resolve(), arguments.build.resolve()
    header = (arguments.source / "host" / "include" / "tetracubes.h").read_text(encoding="utf-8")
    arguments.version = ".".join(re.findall(r"#define TC_VERSION_(?:MAJOR|MINOR|PATCH) (\d+)", header))
    if cached(arguments.build, "TETRACUBES_SANITIZE"):
        print("skipped: consumers would need the sanitizers of this build")
        return 77
    arguments.cmake = cached(arguments.build, "CMAKE_COMMAND")
    arguments.cc = cached(arguments.build, "CMAKE_C_COMPILER")
    arguments.generator = cached(arguments.build, "CMAKE_GENERATOR")
    with tempfile.TemporaryDirectory(prefix="tetracubes-install-") as folder:
        try:
            test(arguments, Path(folder))
        except Failure as failure:
            print(f"FAILED: {failure}")
            return 1
    print("passed")
    return 0


if __name__ == "__main__":
    sys.exit(main())
