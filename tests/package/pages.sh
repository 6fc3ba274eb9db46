#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# pages.sh SOURCE: what pages link to is there, and code that pages for programmers quote is that of the examples, which tests build and run.
set -eu
cd "$1"
status=0

complain() {
  echo "pages: $1" >&2
  status=1
}

for page in README.md $(find include src tests meshes -name '*.md'); do
  folder=$(dirname "$page")
  for link in $(sed '/^ *```/,/^ *```$/d' "$page" | grep -oE '\]\([^)]+\)' | sed 's/^](//; s/)$//; s/#.*//' | sort -u); do
    case $link in
      *://*) ;;
      *) [ -e "$folder/$link" ] || complain "$page links to $link, which isn't there" ;;
    esac
  done
done

# Line by line, without the blanks before them: an example may have comments between them.
code=$(mktemp)
trap 'rm -f "$code"' EXIT
cat tests/examples/*.c tests/examples/*.f90 tests/examples/CMakeLists.txt | sed 's/^ *//' >"$code"
for page in README.md include/README.md; do
  awk '/^ *```(c|fortran|cmake)$/ { inside = 1; next } /^ *```$/ { inside = 0 } inside' "$page" | sed 's/^ *//' | grep -v '^$' | sort -u |
    while IFS= read -r line; do
      grep -qxF -e "$line" "$code" || echo "$page: $line"
    done
done >"$code.missing"
while IFS= read -r line; do
  complain "no example has this line of $line"
done <"$code.missing"
rm -f "$code.missing"
exit $status
