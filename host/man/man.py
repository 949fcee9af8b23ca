#!/usr/bin/env python3
"""man.py - manual pages, from --help of the programs and from the public header

    man.py tool PROGRAM PAGE        tetracubes(1)
    man.py bench PROGRAM PAGE       tetracubes-bench(1)
    man.py ranks PROGRAM PAGE       tetracubes-mpi(1)
    man.py library HEADER PAGE      libtetracubes(3)
    man.py ... --version TEXT       of the project; default 0

Nothing is written here that the sources do not say, but what a manual page begins and ends with. Standard library only.
"""
import argparse
import re
import subprocess
from pathlib import Path

OPTION = re.compile(r"^  ((?:-\w, )?--[a-z-]+(?: [A-Z][A-Z0-9,.\[\]]*)?) +(\S.*)$")
CONTINUED = re.compile(r"^ {12,}(\S.*)$")


def escaped(text):
    """Text as roff takes it: no line is a request, hyphens can be copied."""
    text = text.replace("\\", "\\e").replace("-", "\\-")
    return re.sub(r"^([.'])", r"\\&\1", text, flags=re.MULTILINE)


def literal(lines):
    """Lines that are shown as they are."""
    return [".PP", ".RS 4", ".nf", *map(escaped, lines), ".fi", ".RE"]


def paragraphs(lines):
    """Prose, filled; indented lines as they are; an empty line begins a paragraph."""
    out, prose, shown = [], [], []

    def end():
        if prose:
            out.extend([".PP", *map(escaped, prose)])
        if shown:
            out.extend(literal(shown))
        prose.clear()
        shown.clear()

    for line in lines:
        indented = line.startswith("  ")
        if not line.strip() or (indented and prose) or (not indented and shown):
            end()
        if line.strip():
            (shown if indented else prose).append(line.strip() if not indented else line[2:])
    end()
    return out


def options(lines):
    """Options with their help, each a tagged paragraph; and the lines behind them."""
    out = []
    for number, line in enumerate(lines):
        option, more = OPTION.match(line), CONTINUED.match(line)
        if option:
            name, _, value = option.group(1).rpartition(" ") if re.search(r" [A-Z]", option.group(1)) else (
                option.group(1), "", "")
            out += [".TP", f"\\fB{escaped(name)}\\fR" + (f" \\fI{escaped(value)}\\fR" if value else ""),
                    escaped(option.group(2))]
        elif more:
            out.append(escaped(more.group(1)))
        else:
            return out, lines[number:]
    return out, []


def title(name, section, version):
    return f'.TH {name.upper()} {section} "" "tetracubes {version}" "Tetracubes"'


def help_of(program, *arguments):
    return subprocess.run([program, *arguments, "--help"], stdout=subprocess.PIPE, text=True,
                          check=True).stdout.splitlines()


def split_at(lines, pattern):
    """The lines before the first one that matches, and those behind it."""
    for number, line in enumerate(lines):
        if re.match(pattern, line):
            return lines[:number], lines[number + 1:]
    raise SystemExit(f"man.py: no line '{pattern}' in the help")


def usage(line):
    command, _, rest = line.partition(" ")
    return f"\\fB{escaped(command)}\\fR {escaped(rest)}"


def command_page(program, name):
    """A command of the tool as a subsection."""
    before, behind = split_at(help_of(program, name), r"Options:$")
    listed, rest = options(behind)
    return [f".SS tetracubes {name}", usage(before[0]), *paragraphs(before[1:]), *listed, *paragraphs(rest)]


def tool_page(program, version):
    overview = help_of(program)
    heading, _, about = overview[0].partition(": ")
    names = re.findall(r"^  tetracubes ([a-z]+) ", "\n".join(overview[:overview.index("", 2)]), re.MULTILINE)
    text = [title("tetracubes", 1, version), ".SH NAME", f"tetracubes \\- {escaped(about)}", ".SH SYNOPSIS"]
    for name in names:
        text += [".br", usage(help_of(program, name)[0])] if name != names[0] else [usage(help_of(program, name)[0])]
    body, status = split_at(overview[1:], r"Exit status:")
    status = [next(line for line in overview if line.startswith("Exit status:"))] + status
    body, environment = split_at(body, r"Environment:")
    environment = [next(line for line in overview if line.startswith("Environment:"))] + environment
    text += [".SH DESCRIPTION", escaped(heading + ": " + about + "."), *paragraphs(body), ".SH COMMANDS"]
    for name in names:
        text += command_page(program, name)
    return text + [".SH ENVIRONMENT", *stripped(environment, "Environment: "), ".SH EXIT STATUS",
                   *stripped(status, "Exit status: "), ".SH SEE ALSO",
                   ".BR tetracubes\\-bench (1), libtetracubes (3)"]


def stripped(lines, heading):
    return [escaped(line.removeprefix(heading)) for line in lines if line.strip()]


def bench_page(program, version):
    whole = help_of(program)
    about = whole[0].partition(": ")[2]
    before, behind = split_at(whole, r"Options ")
    note = next(line for line in whole if line.startswith("Options ")).removeprefix("Options ").strip("():")
    listed, rest = options(behind)
    rest, status = split_at(rest, r"Exit status:")
    status = [next(line for line in whole if line.startswith("Exit status:"))] + status
    return [title("tetracubes-bench", 1, version), ".SH NAME", f"tetracubes\\-bench \\- {escaped(about)}",
            ".SH SYNOPSIS", usage(whole[0].partition(":")[0]), ".SH DESCRIPTION", *paragraphs(before[1:]),
            ".SH OPTIONS", escaped(f"Of options with {note}." if note.startswith("*") else note), *listed,
            ".SH FIELDS", *paragraphs(rest), ".SH EXIT STATUS", *stripped(status, "Exit status: "), ".SH SEE ALSO",
            ".BR tetracubes (1)"]


def ranks_page(program, version):
    before, behind = split_at(help_of(program), r"Options:$")
    listed, rest = options(behind)
    return [title("tetracubes-mpi", 1, version), ".SH NAME",
            "tetracubes\\-mpi \\- isosurfaces by the ranks of an MPI job", ".SH SYNOPSIS", usage(before[0]),
            ".SH DESCRIPTION", *paragraphs(before[1:]), ".SH OPTIONS", *listed, *paragraphs(rest), ".SH SEE ALSO",
            ".BR tetracubes (1), mpirun (1)"]


def comment_lines(comment):
    """A comment's text, without its frame."""
    return [re.sub(r"^ ?\* ?", "", line).rstrip() for line in comment[2:-2].strip().split("\n")]


def comment_prose(comment):
    return paragraphs([re.sub(r"^ {3,4}", "  ", line) for line in comment_lines(comment)])


def blocks(text):
    """What empty lines part, but for those within braces."""
    whole = []
    for part in re.split(r"\n\s*\n", text.strip()):
        if whole and whole[-1].count("{") > whole[-1].count("}"):
            whole[-1] += "\n\n" + part
        else:
            whole.append(part)
    return whole


def declarations(text):
    """Comments as prose, code as it is."""
    out = []
    for block in blocks(text):
        found = re.match(r"\s*(/\*.*?\*/)\s*\n(?!\s*$)(.*)$|\s*(/\*.*?\*/)\s*$", block, re.DOTALL)
        comment, code = (found.group(1) or found.group(3), found.group(2)) if found else (None, block)
        if code:
            out += literal(code.replace("TC_API ", "").rstrip().split("\n"))
        if comment:
            out += comment_prose(comment)
    return out


def library_page(header, version):
    text = header.read_text(encoding="utf-8")
    first = re.match(r"/\*.*?\*/", text, re.DOTALL).group(0)
    about = comment_lines(first)[0].partition(" - ")[2]
    parts = re.split(r"^/\* -{10,} ([^-]+?) \*/$", text.rpartition("#ifdef __cplusplus")[0], flags=re.MULTILINE)
    if len(parts) < 9:
        raise SystemExit(f"man.py: {header}: fewer than four sections")
    page = [title("libtetracubes", 3, version), ".SH NAME", f"libtetracubes \\- {escaped(about)}", ".SH SYNOPSIS",
            ".nf", ".B #include <tetracubes.h>", ".PP",
            escaped("cc example.c $(pkg-config --cflags --libs tetracubes)"), ".fi", ".SH DESCRIPTION"]
    page += comment_prose("/*" + first[2:-2].partition("\n")[2].partition("\n")[2] + "*/")
    for name, body in zip(parts[1::2], parts[2::2]):
        page += [f".SH {escaped(name.upper())}", *declarations(body)]
    return page + [".SH SEE ALSO", ".BR tetracubes (1)"]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("kind", choices=["tool", "bench", "ranks", "library"])
    parser.add_argument("source", type=Path)
    parser.add_argument("page", type=Path)
    parser.add_argument("--version", default="0", metavar="TEXT")
    given = parser.parse_args()
    make = {"tool": tool_page, "bench": bench_page, "ranks": ranks_page, "library": library_page}[given.kind]
    given.page.write_text("\n".join(make(given.source, given.version)) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
