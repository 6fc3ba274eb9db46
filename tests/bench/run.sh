#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# run.sh [--small|--large] [--scene NAME] [--rounds N] [--pictures] [-b BUILD] [-o DIR]: measures tetcast beside VTK, see README.md.
# BUILD is a folder in which the tests were built [build-werror], DIR where results go [BUILD/bench].
set -eu
here=$(cd "$(dirname "$0")" && pwd)
build=$here/../../build-werror
results=''
options=''
while [ $# -gt 0 ]; do
  case $1 in
    --small | --large | --pictures) options="$options $1" ;;
    --scene | --rounds) options="$options $1 ${2:?its value is missing}" && shift ;;
    -b) build=${2:?a folder is missing} && shift ;;
    -o) results=${2:?a folder is missing} && shift ;;
    *)
      sed -n '3,4s/^# //p' "$0" >&2
      exit 2
      ;;
  esac
  shift
done
if [ ! -x "$build/bin/tetcast_bench" ]; then
  echo "run.sh: $build/bin/tetcast_bench is missing: build the tests first, or say where with -b" >&2
  exit 1
fi
results=${results:-$build/bench}
mkdir -p "$results"
# shellcheck disable=SC2086  # options have no spaces
"$build/bin/tetcast_bench" $options -o "$results"
if command -v python3 >/dev/null; then
  PYTHONDONTWRITEBYTECODE=1 python3 "$here/report.py" "$results"
else
  echo 'run.sh: no python3: results.csv is there, but no tables and plots' >&2
fi
