#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# ranks.sh PROGRAM FOLDER MPIEXEC…: pictures of a simulation are the same up to rounding, whatever the number of its processes.
set -u
program=$1 folder=$2
shift 2
rm -rf "$folder"
mkdir -p "$folder"
cd "$folder" || exit 1
failures=0
fail() {
  echo "FAILED: $*"
  failures=$((failures + 1))
}
for ranks in 1 2 3 4; do
  "$@" $ranks "$program" of$ranks 2>log || fail "$ranks processes: $(cat log)"
  [ "$(grep -c "unknown shape 'blob'" log)" = 1 ] || fail "$ranks processes: the fault is not told once: $(cat log)"
  [ "$(grep -c 'catalyst/tetcast/scene:1: ' log)" = 1 ] || fail "$ranks processes: the broken scene is not told of once: $(cat log)"
  grep -v -e "unknown shape 'blob'" -e 'catalyst/tetcast/scene:1: ' log && fail "$ranks processes: more is said"
  for step in 00 02 03 04; do
    [ -s of$ranks.$step.ppm ] || { fail "of$ranks.$step.ppm is missing"; continue; }
    [ "$(wc -c <of$ranks.$step.ppm)" = "$(wc -c <of1.$step.ppm)" ] || fail "of$ranks.$step.ppm has another size"
    cmp -l of1.$step.ppm of$ranks.$step.ppm | awk -v name=of$ranks.$step.ppm '
      function value(octal) { return substr(octal, 1, length(octal) - 2) * 64 + substr(octal, length(octal) - 1, 1) * 8 + substr(octal, length(octal)) }
      { d = value($2) - value($3); if (d > 1 || d < -1) bad++ }
      END { if (bad) { print name ": " bad " bytes differ by more than 1"; exit 1 } }' || fail "of$ranks.$step.ppm is another picture"
  done
  [ ! -e of$ranks.01.ppm ] || fail "of$ranks.01.ppm is there"
done
[ "$(sort -u of1.00.ppm of1.02.ppm | wc -c)" -gt 10000 ] && ! cmp -s of1.02.ppm of1.03.ppm || fail "the pictures show nothing"
echo "$failures failures"
[ $failures = 0 ]
