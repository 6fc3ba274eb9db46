# SPDX-License-Identifier: Apache-2.0
# Ctrl-C and a request to terminate end a long run soon and leave nothing.
. "$(dirname "$0")/lib.sh"
needs vtk openimageio
vtu cube.vtu "$five_tetrahedra" 10
before=$(files)
for signal in INT:130 TERM:143 HUP:129 INT:130:0.2; do # the last while libraries are loaded
  checks=$((checks + 1))
  start=$(date +%s%N)
  IFS=: read -r name expected delay <<<"$signal"
  timeout --preserve-status -k 20 -s "$name" "${delay:-1}" "$tetcast" render cube.vtu -o big.tif --size 4000x4000 \
    --samples 1024 --array s --stats stats.json --save-scene scene.json 2>"$work.err"
  code=$?
  elapsed=$((($(date +%s%N) - start) / 1000000))
  [ "$code" = "$expected" ] || fail "exit code $code after $name"
  [ "$elapsed" -lt 4000 ] || fail "$elapsed ms until the end after $name"
  [ "$(cat "$work.err")" = 'tetcast: error: interrupted' ] || fail "standard error: $(cat "$work.err")"
  [ "$before" = "$(files)" ] || fail "files are left: $(files)"
done
rm -f "$work.err"
finish
