#!/usr/bin/env python3
"""The library's binary interface is the one that is written down.

    test_abi.py SOURCE COMPILER LIBRARY [--write]

Enumerators, layouts of structs, types of callbacks and functions are read from tetracubes.h, their values, sizes and
offsets asked of the compiler, and all of it compared with abi.txt, so that no change goes unseen; --write renews that
file. A shared LIBRARY exports these functions and nothing else. Structs with a struct_size may grow at their end only,
from a multiple of 8 bytes on: a struct of an older size is what the lines up to there say. The tables of test_misuse
must name every function, and every field of the structs that callers fill.
"""
import argparse
import difflib
import re
import subprocess
import sys
import tempfile
from pathlib import Path

RESULTS = {"tc_planes", "tc_mesh_piece", "tc_device_info", "tc_tuning", "tc_counts", "tc_timings", "tc_mesh_data", "tc_tetrahedra",
           "tc_interval_volume_counts", "tc_interval_volume_data"}
NO_STATUS = {"tc_message", "tc_version", "tc_context_options_init", "tc_context_destroy", "tc_context_cl_context",
             "tc_seam_size", "tc_stream_options_init", "tc_context_cl_queue", "tc_context_device_bytes", "tc_type_bytes",
             "tc_context_build_ms",
             "tc_type_name", "tc_method_name", "tc_grid_options_init",
             "tc_grid_destroy", "tc_extract_options_init", "tc_mesh_destroy", "tc_tetrahedra_release",
             "tc_interval_volume_options_init", "tc_interval_volume_destroy",
             "tc_tetrahedra_grid_options_init", "tc_expert_options_init", "tc_labels_options_init"}


def header_text(path):
    """The header's declarations, without comments and preprocessor."""
    text = re.sub(r"/\*.*?\*/", " ", path.read_text(encoding="utf-8"), flags=re.DOTALL)
    return re.sub(r"^\s*#.*?(?<!\\)$", "", text, flags=re.MULTILINE)


def parse_enums(text):
    """{enum: [enumerator]}"""
    found = re.findall(r"typedef enum \w+\s*\{(.*?)\}\s*(\w+);", text, re.DOTALL)
    return {name: re.findall(r"\bTC_\w+", body) for body, name in found}


def parse_structs(text):
    """{struct: [field]}; fields in the order of their declaration."""
    structs = {}
    for body, name in re.findall(r"typedef struct \w+\s*\{(.*?)\}\s*(\w+);", text, re.DOTALL):
        fields = []
        for declaration in filter(None, (part.strip() for part in body.split(";"))):
            fields += [re.search(r"(\w+)\s*(?:\[[^]]*\]\s*)*$", part).group(1) for part in declaration.split(",")]
        structs[name] = fields
    return structs


def parse_functions(text):
    """{function: declaration on one line}"""
    found = re.findall(r"TC_API\s+([^;]*?\b(\w+)\([^;]*\));", text)
    return {name: re.sub(r"\s+", " ", declaration) for declaration, name in found}


def compiled(arguments, enums, structs):
    """What the compiler makes of enumerators and structs: lines."""
    lines = []
    for name, enumerators in enums.items():
        lines.append(f'printf("enum {name}, %zu bytes\\n", sizeof({name}));')
        lines += [f'printf("    {e} = %d\\n", (int){e});' for e in enumerators]
    for name, fields in structs.items():
        lines.append(f'printf("struct {name}, %zu bytes, aligned to %zu\\n", sizeof({name}), _Alignof({name}));')
        lines += [f'printf("    %4zu %4zu {field}\\n", offsetof({name}, {field}), sizeof((({name} *)0)->{field}));'
                  for field in fields]
    program = '#include <stdio.h>\n#include "tetracubes.h"\nint main(void) {\n' + "\n".join(lines) + "\nreturn 0;\n}\n"
    with tempfile.TemporaryDirectory(prefix="tetracubes-abi-") as folder:
        source, binary = Path(folder) / "abi.c", Path(folder) / "abi"
        source.write_text(program, encoding="utf-8")
        subprocess.run([arguments.compiler, "-std=c11", f"-I{arguments.source / 'host' / 'include'}", str(source), "-o",
                        str(binary)], check=True)
        return subprocess.run([str(binary)], stdout=subprocess.PIPE, text=True, check=True).stdout.splitlines()


def describe(arguments, text):
    callbacks = [re.sub(r"\s+", " ", line) for line in re.findall(r"typedef [^{};]*\(\*\w+\)[^;]*;", text)]
    lines = ["Binary interface of tetracubes on 64-bit Linux: offset, bytes and name of every field.", ""]
    lines += compiled(arguments, parse_enums(text), parse_structs(text)) + [""]
    return lines + sorted(callbacks) + sorted(f"{line};" for line in parse_functions(text).values())


def gaps(lines):
    """Fields that the parser has missed leave a hole, or an end that no padding explains."""
    faults, end, size_of = [], 0, 0
    for line in [*lines, "struct"]:
        field = re.match(r"\s+(\d+)\s+(\d+) (\w+)$", line)
        if field:
            offset, size = int(field[1]), int(field[2])
            if offset - end >= 8 or offset < end:
                faults.append(f"{field[3]} is at {offset}, and the field before it ends at {end}")
            end = offset + size
        elif line.startswith("struct"):
            if end and size_of and size_of - end >= 8:
                faults.append(f"a struct of {size_of} bytes ends at {end}")
            named = re.match(r"struct \w+, (\d+) bytes", line)
            size_of, end = int(named[1]) if named else 0, 0
    return faults


def exported(library):
    symbols = subprocess.run(["nm", "-D", "--defined-only", library], stdout=subprocess.PIPE, text=True, check=True)
    return set(re.findall(r"^[0-9a-f]+ \w (\w+)", symbols.stdout, re.MULTILINE))


def misuse_faults(arguments, text):
    """Functions and fields that no table of test_misuse names."""
    here = arguments.source / "tests" / "hygiene"
    tables = "".join((here / name).read_text(encoding="utf-8")
                     for name in ("test_misuse.c", "misuse_places.h", "misuse_calls.h"))
    faults = [f"test_misuse.c never calls {name}" for name in parse_functions(text) if f"{name}(" not in tables]
    faults += [f"test_misuse.c has no place for {name}" for name in parse_functions(text)
               if name not in NO_STATUS and not re.search(rf"(?:AT|SIZED|OPTIONS_OF_\w+)\({name}\b", tables)]
    for struct, fields in parse_structs(text).items():
        if struct in RESULTS:
            continue
        name = struct.removeprefix("tc_")
        faults += [f"test_misuse.c spoils no {name}.{field}" for field in fields
                   if field != "struct_size" and not re.search(rf"\b{name}\.{field}\b", tables)]
    return faults


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("source", type=Path, help="folder of the sources")
    parser.add_argument("compiler")
    parser.add_argument("library", help="the shared library; '' where it is static")
    parser.add_argument("--write", action="store_true", help="renew abi.txt")
    arguments = parser.parse_args()
    arguments.source = arguments.source.resolve()
    file = arguments.source / "tests" / "hygiene" / "abi.txt"
    text = header_text(arguments.source / "host" / "include" / "tetracubes.h")
    lines = describe(arguments, text)
    faults = gaps(lines) + misuse_faults(arguments, text)
    if arguments.write:
        file.write_text("\n".join(lines) + "\n", encoding="utf-8")
    written = file.read_text(encoding="utf-8").splitlines()
    faults += difflib.unified_diff(written, lines, "abi.txt", "tetracubes.h", lineterm="", n=0)
    if arguments.library:
        declared, found = set(parse_functions(text)), exported(arguments.library)
        faults += [f"exported, and not in the header: {name}" for name in sorted(found - declared)]
        faults += [f"in the header, and not exported: {name}" for name in sorted(declared - found)]
    for fault in faults:
        print(fault)
    print(f"{len(lines)} lines of abi.txt, {len(faults)} differences")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
