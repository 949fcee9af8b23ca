#!/usr/bin/env python3
"""The README says what is so: options and fields are those of --help, its two commands those of .ci/run, the tests that
it names are there, its table of the long tier is made of the committed results.

    test_readme.py SOURCE BUILD TOOL

Its C example is compiled and run by test_install.py.
"""
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

failures = 0


def expect(condition, text):
    global failures
    if not condition:
        failures += 1
        print(f"FAILED: {text}")


def section(readme, begin, end):
    """Text between two marks; both have to be there."""
    found = re.search(re.escape(begin) + "(.*?)" + re.escape(end), readme, re.DOTALL)
    expect(found, f"README.md: no text between '{begin}' and '{end}'")
    return found.group(1) if found else ""


def help_of(tool, command):
    return subprocess.run([tool, command, "--help"], stdout=subprocess.PIPE, text=True, check=True).stdout


def test_options(readme, tool):
    table = section(readme, "Options of `extract`:", "Exit status:")
    documented = set(re.findall(r"`(--[a-z-]+)|`(-o) ", table))
    documented = {long or "--output" for long, _ in documented}
    known = set(re.findall(r"^  (?:-\w, )?(--[a-z-]+)", help_of(tool, "extract"), re.MULTILINE)) - {"--help"}
    expect(len(known) > 10, f"extract --help: only {len(known)} options found")
    expect(documented - known == set(), f"README.md: not options of extract: {sorted(documented - known)}")
    expect(known - documented == set(), f"README.md: options left out: {sorted(known - documented)}")


def test_fields(readme, tool):
    """The same fields, defined in the same words."""
    table = section(readme, "| field | value |", "\n## ")
    rows = dict(re.findall(r"^\| `([a-z-]+)` \| (.*) \|$", table, re.MULTILINE))
    listed = section(help_of(tool, "generate"), "Fields,", "\n\n")
    known = dict(re.findall(r"^  ([a-z-]+) +(.*)$", listed, re.MULTILINE))
    expect(len(known) >= 6, f"generate --help: only {len(known)} fields found")
    expect(rows.keys() == known.keys(), f"README.md: fields {sorted(rows)}, generate --help: {sorted(known)}")
    for name in rows.keys() & known.keys():
        stated = rows[name].replace("`", "")
        expect(stated == known[name], f"README.md: {name} is '{stated}', in generate --help '{known[name]}'")


def test_commands(readme, source):
    commands = re.findall(r"^    (bash tests/\w+)", section(readme, "## The two commands", "\n## "), re.MULTILINE)
    expect(len(commands) == 2, f"README.md: two commands expected, found {commands}")
    ci = (source / ".ci" / "run").read_text(encoding="utf-8")
    expect(re.findall(r"^(bash \S+)", ci, re.MULTILINE) == commands, f".ci/run does not run {commands}")
    for link in re.findall(r"\]\(([^)#]+)\)", readme):
        expect("://" in link or (source / link).exists(), f"README.md: {link} is not there")


def test_promises(readme, build):
    """Every test that a promise names is one of ctest's."""
    listed = subprocess.run(["ctest", "--test-dir", build, "-N"], stdout=subprocess.PIPE, text=True, check=True).stdout
    known = set(re.findall(r"Test +#\d+: (\w+)", listed))
    cache = (Path(build) / "CMakeCache.txt").read_text(encoding="utf-8")
    if re.search(r"^BUILD_SHARED_LIBS:\w+=(OFF|0|NO|FALSE)$", cache, re.MULTILINE | re.IGNORECASE):
        known.add("test_host_memory")  # replaces the malloc of a shared library
    promises = section(readme, "| promise |", "<!-- trust:begin -->")
    named = re.findall(r"`((?:test|fuzz|mutants|offline)_\w+|oclgrind|memcheck|kernel_warnings)`", promises)
    expect(len(named) > 20, f"README.md: only {len(named)} tests named")
    expect(set(named) <= known, f"README.md: no tests of ctest: {sorted(set(named) - known)}")


def test_figures(source):
    """tests/figures.py would write what is there."""
    with tempfile.TemporaryDirectory() as folder:
        copy = Path(folder) / "README.md"
        shutil.copy(source / "README.md", copy)
        subprocess.run([sys.executable, source / "tests" / "figures.py", "--readme", copy], check=True)
        expect(copy.read_text() == (source / "README.md").read_text(), "README.md: run tests/figures.py")


def main():
    source, build, tool = Path(sys.argv[1]), sys.argv[2], sys.argv[3]
    readme = (source / "README.md").read_text(encoding="utf-8")
    test_options(readme, tool)
    test_fields(readme, tool)
    test_commands(readme, source)
    test_promises(readme, build)
    test_figures(source)
    print(f"{failures} failed")
    return failures > 0


if __name__ == "__main__":
    sys.exit(main())
