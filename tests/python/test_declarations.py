"""The package's declarations of the C interface are what the compiler makes of tetracubes.h."""
import argparse
import ctypes
import inspect
import os
import sys
from pathlib import Path

import pytest
from tetracubes import library

SOURCE = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(SOURCE / "tests" / "hygiene"))
import test_abi as abi  # noqa: E402, its parser of the header

TEXT = abi.header_text(SOURCE / "host" / "include" / "tetracubes.h")


def test_structs_and_enumerators():
    """Sizes, offsets and names of all members; values of all enumerators."""
    compiler = argparse.Namespace(compiler=os.environ.get("TEST_CC", "cc"), source=SOURCE)
    wanted = abi.compiled(compiler, abi.parse_enums(TEXT), abi.parse_structs(TEXT))
    made = []
    for name in abi.parse_enums(TEXT):
        made.append(f"enum {name}, {ctypes.sizeof(ctypes.c_int)} bytes")
        made += [f"    {one.name} = {one.value}" for one in getattr(library, name)]
    for name in abi.parse_structs(TEXT):
        struct = getattr(library, name)
        made.append(f"struct {name}, {ctypes.sizeof(struct)} bytes, aligned to {ctypes.alignment(struct)}")
        made += [f"    {getattr(struct, field[0]).offset:4} {getattr(struct, field[0]).size:4} {field[0]}"
                 for field in struct._fields_]
    assert made == wanted and len(made) > 150


KINDS = {"char *": ctypes.c_char_p, "size_t": ctypes.c_size_t, "double": ctypes.c_double, "uint64_t": ctypes.c_uint64,
         "int": ctypes.c_int, "void": None, "tc_type": ctypes.c_int, "tc_method": ctypes.c_int, "tc_status": ctypes.c_int,
         "tc_progress": library.tc_progress, "void *": ctypes.c_void_p}


def ctype(declared):
    """The type in ctypes of a C type."""
    kind = declared.replace("const ", "").replace("struct ", "").strip()
    if kind in KINDS:
        return KINDS[kind]
    base = kind.rstrip("* ")
    if kind.endswith("**"):
        return ctypes.POINTER(ctypes.c_void_p)
    struct = getattr(library, base, None)
    if inspect.isclass(struct) and issubclass(struct, ctypes.Structure):
        return ctypes.POINTER(struct)
    return ctypes.POINTER(KINDS[base]) if base in ("int", "uint64_t") else ctypes.c_void_p  # a handle, an array


def arguments_of(declaration):
    """Types of the arguments in ctypes, from a declaration in C."""
    made = []
    for argument in declaration[declaration.index("(") + 1:-1].split(","):
        argument = argument.strip()
        if argument == "void":
            continue
        if argument.endswith("[3]"):
            made.append(ctypes.POINTER(ctypes.c_double * 3))
        else:
            made.append(ctype(argument[:len(argument) - len(argument.split()[-1].lstrip("*"))]))
    return made


@pytest.mark.parametrize("name, declaration", abi.parse_functions(TEXT).items())
def test_functions(name, declaration):
    """Return and argument types of every function."""
    result, *arguments = library.FUNCTIONS[name]
    assert result == ctype(declaration[:declaration.index(name)])
    assert arguments == arguments_of(declaration)


def test_no_function_is_left_out():
    assert library.FUNCTIONS.keys() == abi.parse_functions(TEXT).keys()


def test_messages_are_for_every_status():
    assert set(library._EXCEPTIONS) == set(library.tc_status) - {library.tc_status.TC_OK}
