#!/bin/sh
# run_with_cache.sh POOL OWN COMMAND... - runs COMMAND with a cache of PoCL's of its own, OWN: the kernels that tests
# before it built. Those that it builds itself are left in POOL for tests after it. Where TEST_OPTIMISED is set, kernels
# are optimised, and tests are of the long tier.
#
# Processes that run at once have raced in one cache, and an empty one costs seconds per kernel. PoCL writes kernels as
# new files, so links to them will do. A part of the pool appears whole, as it is renamed.
set -eu
pool=$1 own=$2
shift 2
if [ "${TEST_OPTIMISED-}" ]; then unset POCL_EXTRA_BUILD_FLAGS TEST_PLAIN_KERNELS; fi
rm -rf "$own"
mkdir -p "$pool" "$own"
for part in "$pool"/*; do
    if [ -d "$part" ]; then cp -Rlf "$part/." "$own/"; fi
done
touch "$own.begun"
POCL_CACHE_DIR=$own "$@" || exit
built=$pool/.$$
mkdir "$built"
(cd "$own" && find . \( -name '*.so' -o -name '*.bc' \) -newer "$own.begun" -exec cp -l --parents -t "$built" {} +)
rmdir "$built" 2>/dev/null || mv "$built" "$pool/$(basename "$own").$$"
