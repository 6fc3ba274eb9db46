#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# core_only.sh SOURCE WORK: the core configures, builds with some of its tests, and works, with no adapter and no command.
# Environment: CC, CXX.
set -eu
source=$1 work=$2
rm -rf "$work"
mkdir -p "$work"

# quietly COMMAND…: its output is shown only when it fails.
quietly() {
  "$@" >"$work/log" 2>&1 || {
    cat "$work/log" >&2
    echo "core only: failed: $*" >&2
    exit 1
  }
}

# Not optimized, which takes minutes: the sources are those of the whole build, whose tests are about what they do.
quietly cmake -S "$source" -B "$work/build" -DCMAKE_BUILD_TYPE=Debug -DCMAKE_C_FLAGS_DEBUG= -DCMAKE_CXX_FLAGS_DEBUG= \
  -DTETCAST_WERROR=ON -DTETCAST_TEST_CORE_ONLY=OFF \
  -DTETCAST_WITH_VTK=OFF -DTETCAST_WITH_TETGEN=OFF -DTETCAST_WITH_OPENIMAGEIO=OFF -DTETCAST_WITH_MPI=OFF -DTETCAST_WITH_CLI=OFF
quietly cmake --build "$work/build" --parallel 2 --target tetcast test_mesh test_cut test_transfer test_render test_direct \
  test_context
quietly ctest --test-dir "$work/build" --output-on-failure --no-tests=error --parallel 2 \
  --tests-regex '^(mesh|cut|transfer|render|direct|context|package_exports)$'
tail -n 4 "$work/log"
