#!/usr/bin/env python3
"""The public header compiles without a warning in every standard that programs may use, after all standard headers.

    test_header.py SOURCE COMPILER...

test_header.c is compiled as C11, C17 and C23 (c2x where the compiler knows no other name for it), test_header.cpp as
C++11, C++17 and C++20, by the compilers given (of C, or of C and C++) and by GCC and Clang where they are installed.
"""
import shutil
import subprocess
import sys
from pathlib import Path

C_STANDARDS = [("c11",), ("c17",), ("c23", "c2x")]
CPP_STANDARDS = [("c++11",), ("c++17",), ("c++20",)]
OPTIONS = ["-Wall", "-Wextra", "-pedantic", "-Werror", "-fsyntax-only"]


def compiled(compiler, names, source, include):
    """None where the compiler takes the source, else what it says. Of the names of a standard it may know but one."""
    for name in names:
        command = [compiler, f"-std={name}", *OPTIONS, f"-I{include}", str(source)]
        result = subprocess.run(command, stderr=subprocess.PIPE, text=True, check=False)
        if not result.returncode:
            return None
        if name == names[-1] or "-std=" not in result.stderr:
            return result.stderr
    return None


def main():
    source, given = Path(sys.argv[1]), [name for name in sys.argv[2:] if name]
    here, include = Path(__file__).resolve().parent, source / "host" / "include"
    found = {shutil.which(name): "++" in name for name in ("gcc", "clang", "g++", "clang++")}
    found.update({name: "++" in Path(name).name for name in given})
    found.pop(None, None)
    failures = count = 0
    for compiler, is_cpp in found.items():
        for names in CPP_STANDARDS if is_cpp else C_STANDARDS:
            text = compiled(compiler, names, here / ("test_header.cpp" if is_cpp else "test_header.c"), include)
            count += 1
            failures += text is not None
            if text is not None:
                print(f"FAILED: {compiler}, {names[0]}:\n{text}")
    print(f"{count} compilations, {failures} failures")
    return 1 if failures or not count else 0


if __name__ == "__main__":
    sys.exit(main())
