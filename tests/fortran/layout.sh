#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# layout.sh FOLDER HEADER…: writes layout.c and layout.f90 into FOLDER, made from the headers. layout.c has the size of every public struct, the offset and
# the size of each of its members and the value of every constant, as C has them; layout.f90 is a program that compares them with the module's, and doesn't compile
# where the module lacks one.
set -eu
folder=$1
shift
work=$(mktemp)
trap 'rm -f "$work"' EXIT

# Lines of: struct NAME | member STRUCT NAME | constant NAME.
cat "$@" | awk '
  # Without comments, which may go over several lines.
  {
    line = ""
    text = $0
    while (text != "") {
      if (comment) {
        if (!(at = index(text, "*/"))) break
        text = substr(text, at + 2)
        comment = 0
      } else if (at = index(text, "/*")) {
        line = line substr(text, 1, at - 1)
        text = substr(text, at + 2)
        comment = 1
      } else {
        line = line text
        break
      }
    }
    $0 = line
  }
  /^#define TETCAST_MAX_/ { print "constant", $2; next }
  /^typedef struct [A-Za-z]+ [{]/ { inside = "struct"; name = $3; print "struct", name; next }
  /^(typedef )?enum .*[{]/ { inside = "enum"; sub(/.*[{]/, "") }
  inside == "enum" {
    last = /[}]/
    sub(/[}].*/, "")
    count = split($0, words, ",")
    for (i = 1; i <= count; ++i)
      if (match(words[i], /TETCAST_[A-Z0-9_]+/)) print "constant", substr(words[i], RSTART, RLENGTH)
    if (last) inside = ""
    next
  }
  inside == "struct" && /^[}]/ { inside = "" }
  inside == "struct" && match($0, /[a-z_0-9]+(\[[A-Z0-9_]+\])*;/) {
    member = substr($0, RSTART)
    sub(/[[;].*/, "", member)
    print "member", name, member
  }' >"$work"
for kind in struct member constant; do # that something is seen at all
  grep -q "^$kind " "$work" || {
    echo "layout: the headers have no $kind" >&2
    exit 1
  }
done

{
  echo '/* Made by layout.sh. */'
  echo '#include <stddef.h>'
  echo '#include <stdint.h>'
  echo '#include <tetcast/tetcast.h>'
  echo 'int64_t layout_number(int i);'
  echo 'static const int64_t numbers[] = {'
  awk '
    $1 == "struct" { print "  (int64_t)sizeof(" $2 ")," }
    $1 == "member" { print "  (int64_t)offsetof(" $2 ", " $3 "), (int64_t)sizeof(((" $2 " *)0)->" $3 ")," }
    $1 == "constant" { print "  (int64_t)" $2 "," }
    END {
      print "};"
      print "int64_t layout_number(int i) { return numbers[i - 1]; }"
    }' "$work"
} >"$folder/layout.c"

awk '
  BEGIN {
    print "! Made by layout.sh."
    print "program layout"
    print "  use tetcast"
    print "  implicit none"
  }
  { kind[NR] = $1; name[NR] = $2; member[NR] = $3 }
  $1 == "struct" { print "  type(" $2 "), target :: an_" $2 }
  END {
    print "  interface"
    print "    function layout_number(i) bind(c)"
    print "      import"
    print "      integer(c_int), value :: i"
    print "      integer(c_int64_t) :: layout_number"
    print "    end function"
    print "  end interface"
    print "  integer :: compared = 0, differences = 0"
    for (i = 1; i <= NR; ++i) {
      if (kind[i] == "struct") print "  call compare(\"size of " name[i] "\", int(c_sizeof(an_" name[i] "), c_int64_t))"
      if (kind[i] == "member") {
        of = "an_" name[i] "%" member[i]
        print "  call compare(\"place of " name[i] "%" member[i] "\", &"
        print "    address(c_loc(" of ")) - address(c_loc(an_" name[i] ")))"
        print "  call compare(\"size of " name[i] "%" member[i] "\", &"
        print "    int(c_sizeof(" of "), c_int64_t))"
      }
      if (kind[i] == "constant") print "  call compare(\"" name[i] "\", int(" tolower(name[i]) ", c_int64_t))"
    }
    print "  print \"(i0, a)\", compared, \" numbers compared\""
    print "  if (differences > 0) error stop \"the module differs from the headers\""
    print "contains"
    print "  function address(pointer)"
    print "    type(c_ptr), intent(in) :: pointer"
    print "    integer(c_int64_t) :: address"
    print "    address = int(transfer(pointer, 0_c_intptr_t), c_int64_t)"
    print "  end function"
    print "  subroutine compare(what, here)"
    print "    character(len=*), intent(in) :: what"
    print "    integer(c_int64_t), intent(in) :: here"
    print "    compared = compared + 1"
    print "    if (here == layout_number(int(compared, c_int))) return"
    print "    print \"(2a, 2(a, i0))\", what, \":\", \" C \", layout_number(int(compared, c_int)), \", Fortran \", here"
    print "    differences = differences + 1"
    print "  end subroutine"
    print "end program"
  }' "$work" >"$folder/layout.f90"
