#!/usr/bin/env python3
"""The completions for shells know every command and option, complete them in bash, and are code that zsh takes.

    test_completion.py TOOL

zsh and shellcheck are used where they are installed.
"""
import re
import shutil
import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "common"))
from expect import expect, finish, run

TOOL = sys.argv[1]


def printed(shell):
    done = run(TOOL, "--completion", shell)
    expect(done.returncode == 0 and not done.stderr, f"--completion {shell}: {done.returncode} {done.stderr}")
    return done.stdout


def commands():
    """{command: its options, as --help lists them}"""
    names = re.findall(r"^  tetracubes ([a-z]+) ", run(TOOL, "--help").stdout, re.MULTILINE)
    known = {}
    for name in names:
        lines = re.findall(r"^  (-[-\w]+)(?:, (--[a-z-]+))?(?: |$)", run(TOOL, name, "--help").stdout, re.MULTILINE)
        known[name] = {option for line in lines for option in line if option}
    expect(len(known) >= 6 and len(known["extract"]) > 20, f"--help: found {known}")
    return known


def bash_completes(script, line):
    """What bash offers for the last word of the line."""
    words = re.findall(r"=|[^\s=]+", line) + ([""] if line.endswith((" ", "=")) and not line.endswith("=") else [])
    given = " ".join(f"'{word}'" for word in words)
    done = run("bash", "-u", "-c", f". '{script}'; COMP_WORDS=({given}); COMP_CWORD=$((${{#COMP_WORDS[@]}} - 1)); "
                                   "_tetracubes; printf '%s\\n' \"${COMPREPLY[@]}\"", cwd=script.parent)
    expect(done.returncode == 0 and not done.stderr, f"bash, {line!r}: {done.stderr}")
    return set(done.stdout.split())


def test_bash(script, known):
    for line, wanted in [
            ("tetracubes ", known.keys() | {"--help", "--version", "--completion"}),
            ("tetracubes ex", {"extract"}),
            ("tetracubes extract --met", {"--method"}),
            ("tetracubes extract --method ", {"tetra", "hybrid", "snap"}),
            ("tetracubes extract --method=h", {"hybrid"}),
            ("tetracubes extract --method=", {"tetra", "hybrid", "snap"}),
            ("tetracubes extract x.nrrd --iso ", set()),
            ("tetracubes info --type f", {"f32", "f64"}),
            ("tetracubes generate gy", {"gyroid"}),
            ("tetracubes extract a", {"a.nrrd", "a.ply"}),
            ("tetracubes extract -o a", {"a.nrrd", "a.ply"}),
            ("tetracubes selftest --junit a", {"a.nrrd", "a.ply"}),
            ("tetracubes --completion ", {"bash", "zsh"}),
            *((f"tetracubes {name} -", options) for name, options in known.items())]:
        offered = bash_completes(script, line)
        expect(offered == set(wanted), f"bash, {line!r}: offers {sorted(offered)}, wanted {sorted(wanted)}")


# Stands for zsh's own functions: prints what they are given.
ZSH_STUBS = """
_arguments() { print -rl -- "$@" }
_describe() { print -rl -- "${(@P)2}" }
_values() { print -rl -- "$@" }
compdef() { print -r -- "compdef $*" }
"""


def zsh_completes(zsh, script, *words):
    given = " ".join(f"'{word}'" for word in words)
    code = f"{ZSH_STUBS}\n. '{script}'; words=({given}); CURRENT={len(words)}; _tetracubes"
    done = run(zsh, "-f", "-c", code)
    expect(done.returncode == 0 and not done.stderr, f"zsh, {words}: {done.stderr}")
    return done.stdout.splitlines()


def test_zsh(script, known):
    text = script.read_text(encoding="utf-8")
    expect(text.startswith("#compdef tetracubes\n"), "zsh: no #compdef in the first line")
    for name, options in known.items():
        part = re.search(rf"^    {name}\)\n(.*?);;", text, re.MULTILINE | re.DOTALL)
        found = set(re.findall(r"^ +'(-[-\w]+)", part.group(1), re.MULTILINE)) if part else set()
        expect(found == options, f"zsh, {name}: {sorted(found ^ options)}")
    zsh = shutil.which("zsh")
    if not zsh:
        print("no zsh: its script was not run")
        return
    done = run(zsh, "-n", script)
    expect(done.returncode == 0 and not done.stderr, f"zsh -n: {done.stderr}")
    first = zsh_completes(zsh, script, "tetracubes", "")
    expect(first[0] == "compdef _tetracubes tetracubes", f"zsh: {first[0]}")
    expect({line.split(":")[0] for line in first[1:]} >= known.keys(), f"zsh, commands: {first}")
    extract = zsh_completes(zsh, script, "tetracubes", "extract", "--")
    expect("--method=[tetra (default)\\: tetrahedra, five per cube; hybrid\\: marching cubes whose]:M:(tetra hybrid snap)"
           in extract, f"zsh, extract: {extract}")
    expect(any(line.startswith("-o[") and line.endswith(":FILE:_files") for line in extract), f"zsh, -o: {extract}")


def test_help(script):
    """An option that takes one of several names has all of them in its help, as they are in the lists of the library."""
    text = script.read_text(encoding="utf-8")
    choices = set(re.findall(r"'(--[-\w]+)=?\[.*?\]:\w+:\(([^)]+)\)'", text))
    expect({name for name, _ in choices} >= {"--method", "--type", "--format", "--engine", "--endian", "--blocks"},
           f"options with names to choose from: {choices}")
    shown = "".join(run(TOOL, command, "--help").stdout for command in ("extract", "generate", "isovolume"))
    for name, names in choices:
        told = "".join(re.findall(rf"^ +{name} .*\n(?: {{20,}}.*\n)*", shown, re.MULTILINE))
        for one in names.split():
            expect(re.search(rf"\b{one}\b", told), f"the help of {name} lacks {one}: {told}")


def main():
    known = commands()
    with tempfile.TemporaryDirectory(prefix="tetracubes-completion-") as folder:
        scripts = {shell: Path(folder) / f"completion.{shell}" for shell in ("bash", "zsh")}
        for shell, script in scripts.items():
            script.write_text(printed(shell), encoding="utf-8")
        for name in ("a.nrrd", "a.ply", "b.stl"):
            (Path(folder) / name).touch()
        test_bash(scripts["bash"], known)
        test_zsh(scripts["zsh"], known)
        test_help(scripts["zsh"])
        if shutil.which("shellcheck"):
            done = run("shellcheck", "-s", "bash", scripts["bash"])
            expect(done.returncode == 0, f"shellcheck: {done.stdout}")
    for arguments in (["--completion", "fish"], ["--completion"]):
        done = run(TOOL, *arguments)
        expect(done.returncode == 2 and not done.stdout and "zsh" in done.stderr, f"{arguments}: {done}")
    return finish()


if __name__ == "__main__":
    sys.exit(main())
