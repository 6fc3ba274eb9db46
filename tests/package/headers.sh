#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# headers.sh FOLDER…: every public header in FOLDER/tetcast compiles alone, as C and as C++, without a warning.
set -eu
status=0 count=0
includes=''
for folder in "$@"; do
  includes="$includes -I$folder"
done
for folder in "$@"; do
  for header in "$folder"/tetcast/*.h; do
    name=tetcast/$(basename "$header")
    for language in c:c99 c:c17 c++:c++11 c++:c++17; do
      compiler=$CC
      case $language in
        c++:*)
          [ -n "${CXX-}" ] || continue
          compiler=$CXX
          ;;
      esac
      # Twice: the second time the include guard must leave nothing.
      # shellcheck disable=SC2086  # a list of options
      printf '#include <%s>\n#include <%s>\nint tetcast_header_compiles;\n' "$name" "$name" |
        "$compiler" -x "${language%%:*}" -std="${language#*:}" -Wall -Wextra -Wpedantic -Werror $includes -fsyntax-only - || {
        echo "headers: <$name> does not compile alone as ${language#*:}" >&2
        status=1
      }
      count=$((count + 1))
    done
  done
done
[ $count -gt 0 ] || status=1
exit $status
