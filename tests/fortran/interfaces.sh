#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# interfaces.sh MODULE HEADER…: the Fortran module has an interface for every function that the headers declare, with the same arguments in the same
# order, and none besides. Functions with any number of arguments can't have one.
set -eu
module=$1
shift
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# name(argument,argument): of C an argument's name is its last word.
cat "$@" | tr '\n' ' ' | sed 's|/\*|\n&|g; s|\*/|&\n|g' | grep -v '^/\*' | tr '\n' ' ' |
  grep -oE 'TETCAST_API [^(;]*tetcast_[a-z0-9_]+\([^)]*\)' | grep -vF '...' |
  sed -E 's/^[^(]*(tetcast_[a-z0-9_]+)\(/\1(/; s/\[[0-9]*\]//g; s/\(void\)/()/; s/[^,(]*[ *]([a-z0-9_]+)([,)])/\1\2/g' | sort >"$work/c"

sed -n '/^  interface$/,/^  end interface/p' "$module" | sed -e ':a' -e '/&$/N' -e 's/&\n *//' -e 'ta' |
  grep -oE '(function|subroutine) tetcast_[a-z0-9_]+\([^)]*\).* bind\(c\)' | sed -E 's/^[a-z]+ //; s/\).*/)/; s/, */,/g' | sort >"$work/fortran"

[ "$(wc -l <"$work/c")" -gt 15 ] || {
  echo "interfaces: only $(wc -l <"$work/c") functions were found in the headers" >&2
  exit 1
}
if ! diff "$work/c" "$work/fortran" >"$work/difference"; then
  echo 'interfaces: < is declared in C, > in Fortran' >&2
  cat "$work/difference" >&2
  exit 1
fi
echo "$(wc -l <"$work/c") functions"
