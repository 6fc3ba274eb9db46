#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# format.sh SOURCE: whether all of C and C++ is laid out as clang-format does it by .clang-format. Releases of clang-format differ: only 14, that of Debian
# 12, is asked; exit status 77 where there is another one, or none.
set -u
cd "$1" || exit 1
case $(clang-format --version 2>/dev/null) in
  *" version 14."*) ;;
  *) exit 77 ;;
esac
find src include tests meshes -name '*.[ch]' -o -name '*.[ch]pp' | sort | xargs clang-format --dry-run -Werror
