#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# headers.sh FOLDER…: every public header in FOLDER/tetcast compiles alone, as C and as C++ (.hpp as C++17), without a warning; and every field of a public struct
# stands on a line of its own, below a comment of its own.
set -eu
status=0 count=0
includes=''
for folder in "$@"; do
  includes="$includes -I$folder"
done
# check_fields HEADER…: names the fields of structs that have no comment directly above them, share a line, or have a comment behind them. Fails also
# where there is no field at all, which would be the fault of this test.
check_fields() {
  awk '
    function complain(what) { print "headers: " FILENAME ":" FNR ": " what ": " $0; bad = 1 }
    /^typedef (struct|union) .*[{]$/ { inside = 1; above = 0; next }
    /^}/ { inside = 0 }
    !inside { next }
    comment || /^ *\/[*]/ { comment = !/[*]\/$/; above = 1; next }
    /^ *$/ { above = 0; next }
    {
      ++fields
      if (!above) complain("this field has no comment directly above it")
      else if (!/;$/) complain("a field is to fill one line, with its comment above it")
      else if (/,/) complain("each field is to have a line and a comment of its own")
      above = 0
    }
    END { exit bad || fields == 0 }' "$@" >&2
}

for folder in "$@"; do
  for header in "$folder"/tetcast/*.h "$folder"/tetcast/*.hpp; do
    [ -f "$header" ] || continue
    name=tetcast/$(basename "$header")
    languages='c:c99 c:c17 c++:c++11 c++:c++17'
    case $name in
      *.hpp) languages='c++:c++17 c++:c++20' ;;
    esac
    for language in $languages; do
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
check_fields "$1"/tetcast/*.h || status=1
exit $status
