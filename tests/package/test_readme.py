#!/usr/bin/env python3
"""The documents say what is so.

    test_readme.py SOURCE BUILD TOOL

README.md: it is short, its two commands are those of .ci/run, its example prints what it shows. host/tool: options and
fields are those of --help, keys those of --json. host/read: endings are known. host: folders include what they may, and
files that are named are there. kernels: every file in one line. tests: tests that are named are there, tables are made of
the committed results. All: what links lead to is there. C examples are compiled and run by test_install.py.
"""
import json
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "common"))
from expect import expect, finish, run

PAGES = ["README.md", "host/README.md", "host/include/README.md", "host/read/README.md", "host/tool/README.md",
         "host/tool/DRIVERS.md", "host/python/README.md", "host/mpi/README.md", "kernels/README.md", "tests/README.md",
         "bench/README.md", ".github/CONTRIBUTING.md", ".github/CHANGELOG.md"]
README_BYTES = 10240


def section(page, text, begin, end):
    """Text between two marks; both have to be there. An empty mark is the end of the page."""
    found = re.search(re.escape(begin) + "(.*?)" + (re.escape(end) if end else r"\Z"), text, re.DOTALL)
    expect(found, f"{page}: no text between '{begin}' and '{end}'")
    return found.group(1) if found else ""


def help_of(tool, command):
    return run(tool, command, "--help").stdout


def anchors(text):
    """What headings of a page can be linked by, as GitHub makes it."""
    headings = re.findall(r"^#+ (.*)$", re.sub(r"```.*?```", "", text, flags=re.DOTALL), re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading in headings}


def test_links(source, pages):
    for name, text in pages.items():
        for link, anchor in re.findall(r"\]\(([^)#\s]*)(#[^)\s]*)?\)", text):
            if "://" in link:
                continue
            path = (source / name).parent / link if link else source / name
            expect(path.exists(), f"{name}: {link} is not there")
            if anchor and path.suffix == ".md" and path.exists():
                expect(anchor[1:] in anchors(path.read_text(encoding="utf-8")), f"{name}: {link}{anchor} is no heading")
    linked = re.findall(r"\]\(([^)#\s]+\.md)", pages["README.md"])
    for name in PAGES[1:]:
        expect(name in linked or name.startswith(".github/CHANGELOG"), f"README.md does not lead to {name}")


def test_members(source, pages):
    """`member` of `tc_struct` is a member of that struct in the header."""
    header = (source / "host/include/tetracubes.h").read_text(encoding="utf-8")
    named = [(name, *found) for name, text in pages.items() for found in re.findall(r"`(\w+)` of `(tc_\w+)`", text)]
    expect(len(named) > 5, f"only {len(named)} members of structs are named")
    for name, member, struct in named:
        body = re.search(rf"typedef struct {struct} \{{(.*?)\n\}} {struct};", header, re.DOTALL)
        expect(body and re.search(rf"\b{member}\b", body.group(1)), f"{name}: {struct} has no {member}")


def test_formats(tool):
    """Help names every format that is written; what is read is printed from the table (test_formats.c has the README)."""
    version = run(tool, "--version").stdout
    reads, writes = version.split("reads: ")[1].split("writes: ")
    meshes, complexes = (re.findall("[A-Z]{3,}", part) for part in writes.split("\n")[0].split(";"))
    expect(len(meshes) >= 4 and complexes, f"--version: writes {meshes}, {complexes}")
    text = " ".join(help_of(tool, "extract").split())
    expect(" ".join(reads.split()) in text, "extract --help: not what --version says that is read")
    output, form = (text[text.index(option):] for option in ("-o, --output", "--format F"))
    for name in meshes:
        expect("." + name.lower() in output[:200], f"extract --help: no .{name.lower()} of --output")
        expect(name.lower() in form[:60], f"extract --help: no {name.lower()} of --format")
    for name in complexes:
        expect("." + name.lower() in help_of(tool, "tetrahedralize"), f"tetrahedralize --help: no {name}")


# ------------------------------------------------------------------------------------------------------- README.md

def test_readme(source, pages, tool):
    text = pages["README.md"]
    expect(len(text.encode()) <= README_BYTES, f"README.md has {len(text.encode())} bytes, more than {README_BYTES}")
    commands = re.findall(r"^    (bash tests/\w+)", section("README.md", text, "## The two commands", "\n## "),
                          re.MULTILINE)
    expect(len(commands) == 2, f"README.md: two commands expected, found {commands}")
    ci = (source / ".ci" / "run").read_text(encoding="utf-8")
    expect(re.findall(r"^(bash \S+)", ci, re.MULTILINE) == [*commands, "bash tests/analysis"],
           f".ci/run does not run {commands}, then tests/analysis")
    example = re.findall(r"^    (.*)$", section("README.md", text, "## Example", "\n`tetracubes info"), re.MULTILINE)
    calls = [line[2:].split()[1:] for line in example if line.startswith("$ ")]
    with tempfile.TemporaryDirectory() as folder:
        for call in calls:
            if call[0] == "extract":  # by the reference, which --verify would prove nothing of
                call = [*(word for word in call if word != "--verify"), "--engine", "reference"]
            done = run(tool, *call, cwd=folder)
            expect(done.returncode == 0, f"README.md: {call}: {done.stderr}")
    printed = {line for line in done.stdout.splitlines() if " ms" not in line and line != "reference engine"}
    shown = {line for line in example if not line.startswith(("$ ", "pthread", "  verify ")) and " ms" not in line}
    expect(len(shown) > 6 and shown == printed, f"README.md: the example prints also {sorted(printed - shown)}, and not "
                                                f"{sorted(shown - printed)}")


# ------------------------------------------------------------------------------------------------------- host/tool

def test_options(text, tool):
    page = "host/tool/README.md"
    table = section(page, text, "## Options of `extract`", "\n## ")
    documented = set(re.findall(r"`(--[a-z-]+)|`(-o) ", re.sub(r"^\| (.*?) \|.*$", r"\1", table, flags=re.MULTILINE)
                                .partition("`info`, `tetra")[0]))
    documented = {long or "--output" for long, _ in documented}
    known = set(re.findall(r"^  (?:-\w, )?(--[a-z-]+)", help_of(tool, "extract"), re.MULTILINE)) - {"--help"}
    expect(len(known) > 10, f"extract --help: only {len(known)} options found")
    expect(documented - known == set(), f"{page}: not options of extract: {sorted(documented - known)}")
    expect(known - documented == set(), f"{page}: options left out: {sorted(known - documented)}")


def test_fields(text, tool):
    """The same fields, defined in the same words."""
    page = "host/tool/README.md"
    table = section(page, text, "| field | value |", "\n## ")
    rows = dict(re.findall(r"^\| `([a-z-]+)` \| (.*) \|$", table, re.MULTILINE))
    listed = section("generate --help", help_of(tool, "generate"), "Fields,", "\n\n")
    known = dict(re.findall(r"^  ([a-z-]+) +(.*)$", listed, re.MULTILINE))
    expect(len(known) >= 6, f"generate --help: only {len(known)} fields found")
    expect(rows.keys() == known.keys(), f"{page}: fields {sorted(rows)}, generate --help: {sorted(known)}")
    for name in rows.keys() & known.keys():
        stated = rows[name].replace("`", "")
        expect(stated == known[name], f"{page}: {name} is '{stated}', in generate --help '{known[name]}'")


def keys_of(value):
    if isinstance(value, dict):
        return set(value).union(*map(keys_of, value.values()))
    return set().union(*map(keys_of, value)) if isinstance(value, list) else set()


def test_keys_of(text, command, known):
    """All of these keys are in the command's table, and no others."""
    page = "host/tool/README.md"
    rows = section(page, text, f"| of `{command}` | |", "\n\n")
    documented = set(re.findall(r"`([a-z_]+)`", rows)) - {"option"}  # of choices, which an input leaves open or not
    expect(known == documented, f"{page}, {command}: keys left out: {sorted(known - documented)}, not there: "
                                f"{sorted(documented - known)}")


def test_keys(text, tool):
    """Keys of reports of extract with every option that adds some."""
    page = "host/tool/README.md"
    table = section(page, text, "| of `extract` | |", "With `--count`")
    documented = set(re.findall(r"`([a-z_0-9]+)`", table)) - {"extract", "verified"}
    documented -= {"ranks", "cut", "sent_bytes"}  # of tetracubes-mpi: tests/mpi/test_ranks.py
    with tempfile.TemporaryDirectory() as folder:
        run(tool, "generate", "sphere", "--dims", "9,9,9", "--type", "u8", "-o", "a.nrrd", cwd=folder)
        extract = [tool, "extract", "a.nrrd", "--iso", "128", "--engine", "reference", "--json", "--quiet"]
        for command, more in ("info", []), ("tetrahedralize", ["-o", "a.vtu"]):
            test_keys_of(text, command, keys_of(json.loads(run(tool, command, "a.nrrd", *more, "--json",
                                                               cwd=folder).stdout)))
        known, options = set(), [["--check", "--soup", "-o", "a.ply"], ["--drop-degenerate"], ["--count"], ["--stream"],
                                 ["-o", "a.part", "--part", "0/1"], ["-o", "a.ply", "--blocks", "separate"],
                                 ["--preview", "a.png", "--blocks", "separate"], ["--preview", "a.png"],
                                 ["--simplify", "0.5"]]
        version = run(tool, "--version").stdout
        if "pictures: PNG" not in version:
            options = [more for more in options if "--preview" not in more]
            documented -= {"preview", "previews"}
        if "simplifies: meshoptimizer" not in version:
            options.pop()
            documented -= {"simplified", "share", "vertices_before", "triangles_before", "distance_to", "distance_from",
                           "simplify"}
        for more in options:
            done = run(*extract, *more, cwd=folder)
            expect(done.returncode == 0, f"{more}: {done.stderr}")
            known |= keys_of(json.loads(done.stdout))
        joined = run(tool, "join", "a.part", "-o", "b.ply", "--json", cwd=folder)
        test_keys_of(text, "join", keys_of(json.loads(joined.stdout)))
    expect(known == documented, f"{page}: keys left out: {sorted(known - documented)}, not there: "
                                f"{sorted(documented - known)}")


# ------------------------------------------------------------------------------------------------------- host/read

def test_endings(text, tool):
    """An empty file of every ending is taken for its format; endings of bare data, which many formats have, apart."""
    table = section("host/read/README.md", text, "| format | endings |", "\n\n")
    endings = set(re.findall(r"`(\.\w+)`", table)) - {".raw", ".img", ".gz"}
    expect(len(endings) > 12, f"host/read/README.md: only {sorted(endings)} found")
    with tempfile.TemporaryDirectory() as folder:
        for ending in endings | {".unknown"}:
            path = Path(folder) / f"a{ending}"
            path.write_bytes(b" " * 512)
            done = run(tool, "info", path)
            unknown = "format is not known" in done.stderr
            expect(unknown == (ending == ".unknown"), f"host/read/README.md: {ending}: {done.stderr}")


# ------------------------------------------------------------------------------------------------------------ host

def room_of(path, rooms):
    """The innermost folder of the table that a file of the sources lies in."""
    return max((room for room in rooms if path.is_relative_to(room)), key=lambda room: len(room.parts), default=None)


def included(path, name, source, rooms):
    """The file that an include means: beside the file, in the library, among the rooms."""
    own = room_of(path, rooms)
    library = source / "host" / "lib"
    places = [path.parent, *([library] if own.is_relative_to(library) else []), source / "host" / "common",
              source, *(room for room in rooms if not room.is_relative_to(library))]
    return next((place / name for place in places if (place / name).exists()), None)


def circle_in(includes):
    """What is left of {path: what it includes} once paths that include none of the others are taken out, again and again."""
    left = dict(includes)
    while ends := [path for path in left if not any(other in left for other in left[path])]:
        for path in ends:
            del left[path]
    return sorted(left)


def test_rooms(source, text):
    """No file includes what the table does not allow; no folders, and no files of the tool, include each other."""
    rows = re.findall(r"^\| `((?:host/|kernels)[\w/]*)` \| .* \| (.*?) ?\|$", text, re.MULTILINE)
    rooms = {source / name: allowed for name, allowed in rows}
    expect(len(rooms) >= 15, f"host/README.md: only {len(rooms)} folders")
    folders = {path.parent for path in (source / "host").rglob("*.c")} - rooms.keys()
    expect(not folders, f"host/README.md: these folders are left out: {sorted(map(str, folders))}")
    places = [*rooms, source / "kernels"]
    over_rooms, over_files = {}, {}
    for path in sorted((source / "host").rglob("*.[ch]")):
        own = room_of(path, places)
        for name in re.findall(r'^#include "([^"]+)"', path.read_text(encoding="utf-8"), re.MULTILINE):
            found = included(path, name, source, places)
            other = room_of(found, places) if found else None
            if found and found.stem != path.stem and path.is_relative_to(source / "host" / "tool"):
                over_files.setdefault(path.with_suffix(""), set()).add(found.with_suffix(""))
            if other is None or other in (own, source / "host" / "include"):
                continue
            over_rooms.setdefault(own, set()).add(other)
            wanted = f"`{other.relative_to(source)}`"
            whole = "all of `host/lib`" in rooms[own] and other.is_relative_to(source / "host" / "lib")
            expect(wanted in rooms[own] or whole, f"{path.relative_to(source)} includes {name} of {wanted}, which "
                                                  "host/README.md does not allow its folder")
    expect(sum(map(len, over_rooms.values())) > 30, f"only {over_rooms} found")
    for what, includes in ("rooms", over_rooms), ("files of host/tool", over_files):
        circle = circle_in(includes)
        expect(not circle, f"{what} include each other: {[str(path.relative_to(source)) for path in circle]}")


def test_paths(source, pages):
    """Names of files in code spans: from the top, from the page's folder, in a room of kernels on their page, or beside a
    path before it in the same cell."""
    for page, text in pages.items():
        for cell in re.split(r"[|\n]", text):
            home = folder = (source / page).parent
            rooms = sorted(home.glob("*/")) if page == "kernels/README.md" else []
            for name in re.findall(r"`([\w*./-]+\.(?:cl|c|h|inc|py|txt)|[\w./-]+\.\*)`", cell):
                if "NAME" in name:  # stands for what is to be made
                    folder = (source / name).parent if "/" in name else folder
                if "NAME" in name or name.startswith((".", "share/")) or name in ("CMakeLists.txt", "tetracubes.h"):
                    continue
                base = next((base for base in (folder, source, home, *rooms) if list(base.glob(name))), None)
                expect(base, f"{page}: {name} is not there")
                folder = (base / name).parent if base else folder


# --------------------------------------------------------------------------------------------------- kernels, tests

def test_kernels(source, text):
    table = section("kernels/README.md", text, "## The files", "## Sources")
    named = re.findall(r"`(\w+\.(?:cl|h))`", "\n".join(line.split(" | ")[0] for line in table.split("\n")))
    there = sorted(path.name for path in (source / "kernels").glob("*/*.[ch]*"))
    expect(sorted(named) == there, f"kernels/README.md: files left out, too many or twice: "
                                   f"{sorted(set(named) ^ set(there))}")


def test_promises(text, build):
    """Every test that a promise names is one of ctest's, and every test is named, or is another run of one that is."""
    listed = run("ctest", "--test-dir", build, "-C", "Analysis", "-N").stdout
    known = set(re.findall(r"Test +#\d+: (\w+)", listed))
    cache = (Path(build) / "CMakeCache.txt").read_text(encoding="utf-8")
    if re.search(r"^BUILD_SHARED_LIBS:\w+=(OFF|0|NO|FALSE)$", cache, re.MULTILINE | re.IGNORECASE):
        known.add("test_host_memory")  # replaces the malloc of a shared library
    promises = section("tests/README.md", text, "| promise |", "\n## ")
    named = re.findall(r"`((?:test|fuzz|mutants|offline|bench)_\w+|oclgrind|memcheck|kernel_warnings)`", promises)
    expect(len(named) > 20, f"tests/README.md: only {len(named)} tests named")
    expect(set(named) <= known, f"tests/README.md: no tests of ctest: {sorted(set(named) - known)}")
    lost = {name for name in known if name.startswith("test_") and not any(f"{name}_".startswith(f"{other}_")
                                                                           for other in named)}
    expect(not lost, f"tests/README.md: no promise names these tests: {sorted(lost)}")


def test_map(source, text):
    """Every folder of tests is in the map."""
    table = section("tests/README.md", text, "| folder |", "\n\n")
    named = set(re.findall(r"^\| `(\w+)` \|", table, re.MULTILINE))
    there = {path.name for path in (source / "tests").iterdir() if path.is_dir() and path.name != "__pycache__"}
    expect(named == there, f"tests/README.md: folders {sorted(named ^ there)}")


def test_figures(source):
    """tests/figures.py would write what is there."""
    with tempfile.TemporaryDirectory() as folder:
        copy = Path(folder) / "README.md"
        shutil.copy(source / "tests" / "README.md", copy)
        subprocess.run([sys.executable, source / "tests" / "figures.py", "--page", copy], check=True)
        expect(copy.read_text() == (source / "tests" / "README.md").read_text(), "tests/README.md: run tests/figures.py")


def main():
    source, build, tool = Path(sys.argv[1]).resolve(), sys.argv[2], Path(sys.argv[3]).resolve()
    pages = {name: (source / name).read_text(encoding="utf-8") for name in PAGES}
    test_links(source, pages)
    test_members(source, pages)
    test_readme(source, pages, tool)
    test_formats(tool)
    test_options(pages["host/tool/README.md"], tool)
    test_fields(pages["host/tool/README.md"], tool)
    test_keys(pages["host/tool/README.md"], tool)
    test_endings(pages["host/read/README.md"], tool)
    test_rooms(source, pages["host/README.md"])
    test_paths(source, {name: text for name, text in pages.items() if "CHANGELOG" not in name})
    test_kernels(source, pages["kernels/README.md"])
    test_promises(pages["tests/README.md"], build)
    test_map(source, pages["tests/README.md"])
    test_figures(source)
    return finish()


if __name__ == "__main__":
    sys.exit(main())
