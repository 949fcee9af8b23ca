#!/bin/sh
# run.sh PACKAGE PYTHON - pytest on the package in that folder; 77 where that Python has no numpy or no pytest
if ! "$2" -c 'import numpy, pytest' 2>/dev/null; then
    echo "skipped: no numpy or no pytest (Debian: python3-numpy python3-pytest)"
    exit 77
fi
PYTHONPATH=$1 PYTHONDONTWRITEBYTECODE=1 exec "$2" -m pytest -q -p no:cacheprovider "$(dirname "$0")"
