# SPDX-License-Identifier: Apache-2.0
# --tiles gives the file of the whole picture, to the byte.
. "$(dirname "$0")/lib.sh"
needs vtk openimageio
vtu cube.vtu "$five_tetrahedra" 10
mesh=cube.vtu

# pair OPTIONS…: several bands, the last of them not whole; statistics but for times.
pair() {
  local format
  for format in ${formats:-exr tif}; do
    accept render $mesh --size ${size:-61x171} -o whole.$format --stats whole.json "$@"
    accept render $mesh --size ${size:-61x171} -o parts.$format --stats parts.json --tiles ${rows:-64} "$@"
    same whole.$format parts.$format "$format $*"
    same <(grep -v 'seconds\|peak' whole.json) <(grep -v 'seconds\|peak' parts.json) "statistics: $*"
  done
}
formats='exr tif png' pair
formats=png pair --pixel-type uint16 --background 0.2,0.4,0.6,0.3 --exposure 1
formats=tif pair --pixel-type uint8
formats=tif pair --pixel-type double --samples 6
pair --pixel-type float --outline red --edges blue --surface white:0.4 --eye 2,3,1.5
pair --outline black --ortho 1.3 --eye 2,3,1.5
formats=tif pair --tolerance 1e-3 --channels error
pair --channels depth,normal,cells --isosurface 2.5 --slice 0,0,1,0.4:0.5
pair --shade volume --light 1,2,3 --shadows --ambient-occlusion 8
pair --blend maximum --channels value
pair --extinction s --emission s --channels radiance,optical_depth,path_length
pair --traversal faces --isa scalar
pair --integrator gauss:3 --clip 1,1,0,0.7
pair --eye 0.5,0.5,0.5 --target 1,0.3,0.2 --array 'c d'
rows=100 size=40x300 pair # 128 it is
rows=1 size=40x64 pair
size=40x65 pair
accept render cube.vtu --size 40x30 -o whole.png
accept render cube.vtu --size 40x30 -o parts.png --tiles
same whole.png parts.png 'by itself'
# Many vertices for few rays, and the other way round: whether they are projected is a matter of the whole picture.
if [ -f "$TETCAST_DATA/volumes/disk_out_ref.ex2" ]; then
  mesh=$TETCAST_DATA/volumes/disk_out_ref.ex2 formats=tif size=20x150 pair --pixel-type double
fi

accept render cube.vtu --size 61x171 -o parts.tif --tiles 64 --save-scene s.json
mkdir again
sed 's|"input": "|"input": "../|' s.json >again/s.json
accept render --scene again/s.json
same parts.tif again/parts.tif scene
grep -q '"tiles": "64"' s.json || fail "$(cat s.json)"
warn 'shows nothing' render cube.vtu --size 61x171 -o parts.png --tiles --eye 5,5,5 --target 6,6,6

# What can't be, and what can't be written: nothing is left.
sed 's/"s" format="ascii">[^<]*/"s" format="ascii">0 1 3 2 3 1e9 1e9 1e9/' cube.vtu >bright.vtu
refuse 1 'pixels of type half hold no values beyond 65504' render bright.vtu --size 61x171 --emission s -o bright.exr --tiles 64
checks=$((checks + 1))
(ulimit -f 4; "$tetcast" render cube.vtu --size 600x600 --pixel-type double -o full.tif --tiles 64 2>"$work.err") &&
  fail 'a file too large was written'
grep -q "cannot write image 'full.tif': File too large" "$work.err" || fail "$(cat "$work.err")"
[ "$(wc -l <"$work.err")" = 2 ] || fail "$(cat "$work.err")" # a note, and the error
[ ! -e full.tif ] && [ -z "$(find . -name '.tetcast*')" ] || fail "files are left: $(files)"
for format in tif exr png; do
  env --default-signal=INT "$tetcast" render cube.vtu --size 400x60000 --samples 9 -o slow.$format --tiles 64 --quiet 2>"$work.err" &
  pid=$!
  for _ in $(seq 600); do
    [ -z "$(find . -name '.tetcast*' -size +0)" ] || break
    sleep 0.02
  done
  kill -s INT "$pid"
  wait "$pid"
  code=$?
  checks=$((checks + 1))
  [ "$code" = 130 ] && [ "$(cat "$work.err")" = 'tetcast: error: interrupted' ] || fail "exit code $code: $(cat "$work.err")"
  [ ! -e slow.$format ] && [ -z "$(find . -name '.tetcast*')" ] || fail "files are left: $(files)"
done
refuse 2 'only .png, .exr and .tif are written in parts' render cube.vtu -o bad.jpg --tiles
refuse 2 'for one picture' render cube.vtu --time all --tiles
refuse 2 'for one picture' render cube.vtu --orbit 3 --tiles
refuse 2 'not possible with --deep, --stop-depth, --adaptive or --repeat' render cube.vtu --tiles --adaptive 0.1
refuse 2 'not possible with --deep, --stop-depth, --adaptive or --repeat' render cube.vtu --tiles --repeat 2
refuse 2 'with --blend additive' render cube.vtu --tiles --blend additive
refuse 2 'a whole number of rows' render cube.vtu --tiles=0 -o bad.png
refuse 2 'a whole number of rows' render cube.vtu --tiles=x -o bad.png
finish
