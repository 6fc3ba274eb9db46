#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# run.sh [--small|--large] [--scene NAME] [--rounds N] [--pictures] [-b BUILD] [-o DIR]: measures tetcast beside VTK, see README.md.
# run.sh --against OTHER [--small] [--scene NAME] [--rounds N] [-b BUILD] [-o DIR]: measures it beside another build of it.
# BUILD is a folder in which the tests were built [build-werror], OTHER one in which another version was, DIR where results go [BUILD/bench].
set -eu
here=$(cd "$(dirname "$0")" && pwd)
build=$here/../../build-werror
results=''
options=''
other=''
while [ $# -gt 0 ]; do
  case $1 in
    --small | --large | --pictures) options="$options $1" ;;
    --scene | --rounds) options="$options $1 ${2:?its value is missing}" && shift ;;
    --against) other=${2:?a folder is missing} && shift ;;
    -b) build=${2:?a folder is missing} && shift ;;
    -o) results=${2:?a folder is missing} && shift ;;
    *)
      sed -n '3,5s/^# //p' "$0" >&2
      exit 2
      ;;
  esac
  shift
done

# must_exist FILE: ends the script if it isn't there.
must_exist() {
  if [ ! -e "$1" ]; then
    echo "run.sh: $1 is missing: build the tests first, or say where with -b" >&2
    exit 1
  fi
}

# text LIBRARY: the bytes of its code and constants; 0 without the program that tells.
text() {
  if command -v size >/dev/null; then
    size "$1" | awk 'NR == 2 { print $1 }'
  else
    echo 0
  fi
}

# commit BUILD: what version control knows the sources by that the folder lies in.
commit() {
  git -C "$1" describe --always --dirty 2>/dev/null || echo unknown
}

results=${results:-$build/bench}
mkdir -p "$results"
if [ -n "$other" ]; then
  must_exist "$build/bin/tetcast_bench_against"
  must_exist "$build/lib/libtetcast.so"
  if [ ! -e "$other/lib/libtetcast.so" ]; then
    echo "run.sh: $other/lib/libtetcast.so is missing: --against takes a folder in which another version was built" >&2
    exit 1
  fi
  # shellcheck disable=SC2086  # options have no spaces
  exec "$build/bin/tetcast_bench_against" $options -o "$results" \
    --text "$(text "$build/lib/libtetcast.so")" "$(text "$other/lib/libtetcast.so")" \
    --names "$(commit "$build")" "$(commit "$other")" \
    "$build/lib/libtetcast.so" "$other/lib/libtetcast.so"
fi
must_exist "$build/bin/tetcast_bench"
# shellcheck disable=SC2086  # options have no spaces
"$build/bin/tetcast_bench" $options -o "$results"
if command -v python3 >/dev/null; then
  PYTHONDONTWRITEBYTECODE=1 python3 "$here/report.py" "$results"
else
  echo 'run.sh: no python3: results.csv is there, but no tables and plots' >&2
fi
