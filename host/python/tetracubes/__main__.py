"""The command-line tool, which lies beside this file: python -m tetracubes --help."""
import os
import sys

from .library import FOLDER


def main() -> None:
    """Becomes the tool."""
    os.execv(FOLDER / "tetracubes", ["tetracubes", *sys.argv[1:]])


if __name__ == "__main__":
    main()
