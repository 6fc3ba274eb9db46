#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# exports.sh INCLUDE INCLUDE LIBRARY…: the libraries export the functions that the headers declare, and no other; libtetcast is linked
# with no adapter's library.
set -eu
declared=$(mktemp) exported=$(mktemp)
trap 'rm -f "$declared" "$exported"' EXIT
status=0

complain() {
  echo "exports: $1" >&2
  status=1
}

cat "$1"/tetcast/*.h "$2"/tetcast/*.h | tr '\n' ' ' | grep -oE 'TETCAST_API [^(;]*\(' | grep -oE 'tetcast_[a-z0-9_]+' | sort -u >"$declared"
shift 2
core=$1 all=true
for library in "$@"; do
  # Strong symbols only: C++ shares templates' and type information's weak ones between libraries by design. The exceptions are the
  # linker's own, and a function of TetGen's that ends the process: the adapter puts one in its place that does not.
  nm -D --defined-only "$library" | awk '$2 ~ /[TBDRG]/ { print $3 }' |
    grep -vE '^(__bss_start|_edata|_end|_Z15terminatetetgenP10tetgenmeshi)$' >>"$exported" || :
done
[ $# -eq 5 ] || all=false # some adapter was not built: its functions are missing, rightly
for symbol in $(sort "$exported" | comm -13 "$declared" -); do
  complain "$symbol is exported, but no header declares it"
done
if $all; then
  for symbol in $(sort "$exported" | comm -23 "$declared" -); do
    complain "$symbol is declared, but no library exports it"
  done
fi
for symbol in $(nm -D --defined-only "$core" | awk '{ print $3 }' | grep -v '^tetcast_'); do
  complain "libtetcast exports $symbol"
done
for needed in $(readelf -d "$core" | sed -n 's/.*(NEEDED).*\[\(.*\)\]/\1/p' | grep -E 'vtk|libtet[.0-9]|libtet\.|OpenImageIO|libmpi|stdc\+\+|jansson'); do
  complain "libtetcast is linked with $needed"
done
exit $status
