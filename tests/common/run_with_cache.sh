#!/bin/sh
# run_with_cache.sh WARM OWN COMMAND... - runs COMMAND with a kernel cache of its own, OWN: a copy of all those in WARM
#
# Processes that run at once have raced in one cache, and an empty one costs seconds per kernel.
set -eu
warm=$1 own=$2
shift 2
rm -rf "$own"
mkdir -p "$own"
for part in "$warm"/*; do cp -R "$part/." "$own/"; done
POCL_CACHE_DIR=$own
export POCL_CACHE_DIR
exec "$@"
