#!/bin/sh
# run_with_cache.sh WARM OWN COMMAND... - runs COMMAND with a kernel cache of its own, OWN: a copy of all those in WARM,
# and of WARM_TOO in the environment, the cache of a test before, if that is there
#
# Processes that run at once have raced in one cache, and an empty one costs seconds per kernel.
set -eu
warm=$1 own=$2
shift 2
rm -rf "$own"
mkdir -p "$own"
for part in "$warm"/* "${WARM_TOO:-$warm}"; do
    if [ "$part" != "$warm" ] && [ -d "$part" ]; then cp -R "$part/." "$own/"; fi
done
POCL_CACHE_DIR=$own
export POCL_CACHE_DIR
exec "$@"
