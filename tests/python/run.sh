#!/bin/sh
# run.sh PACKAGE PYTHON - pytest on the package in that folder; 77 where no Python has numpy and pytest
#
# Debian's packages belong to /usr/bin/python3, which need not be the first that is found.
for python in /usr/bin/python3 "$2"; do
    if "$python" -c 'import numpy, pytest' 2>/dev/null; then
        PYTHONPATH=$1 PYTHONDONTWRITEBYTECODE=1 exec "$python" -m pytest -q -p no:cacheprovider "$(dirname "$0")"
    fi
done
echo "skipped: no numpy and pytest (Debian: python3-numpy python3-pytest)"
exit 77
