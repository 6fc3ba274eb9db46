#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# format.sh SOURCE: whether all of C and C++ is laid out as clang-format does it by .clang-format, and tables (.def), which it doesn't lay out, have lines
# of 120 characters at most. Releases of clang-format differ: only 14, that of Debian 12, is asked; exit status 77 where there is another one, or none.
set -u
cd "$1" || exit 1
long=$(find src include tests meshes -name '*.def' | sort | LC_ALL=C.UTF-8 xargs grep -nE '^.{121}' /dev/null)
if [ -n "$long" ]; then
  printf 'format: lines of more than 120 characters:\n%s\n' "$long" >&2
  exit 1
fi
case $(clang-format --version 2>/dev/null) in
  *" version 14."*) ;;
  *) exit 77 ;;
esac
find src include tests meshes -name '*.[ch]' -o -name '*.[ch]pp' | sort | xargs clang-format --dry-run -Werror
