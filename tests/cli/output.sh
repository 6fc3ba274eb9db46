# SPDX-License-Identifier: Apache-2.0
# What a run writes, and that it writes all of it or nothing.
. "$(dirname "$0")/lib.sh"
needs vtk openimageio
vtu cube.vtu "$five_tetrahedra" 10

# Names and formats.
accept render cube.vtu --size 40x30
exists cube.png
for name in a.png a.exr a.tif a.tiff a.jpg a.jpeg; do
  accept render cube.vtu -o $name --size 40x30
  exists $name
done
for pair in png:uint16 exr:float tif:uint8 tif:uint16 tif:half tif:float tif:double; do
  accept render cube.vtu -o "${pair#*:}.${pair%:*}" --size 40x30 --pixel-type "${pair#*:}"
done
echo old >old.png
accept render cube.vtu -o old.png --size 40x30
same old.png cube.png
mkdir folder
accept render cube.vtu -o folder/a.png --size 40x30
same folder/a.png cube.png

# What must not change the picture.
accept render cube.vtu -o one.tif --size 61x47 --pixel-type double --threads 1
accept render cube.vtu -o two.tif --size 61x47 --pixel-type double --threads 2
same one.tif two.tif 'threads'
accept render cube.vtu -o again.tif --size 61x47 --pixel-type double --repeat 3 --quiet
same one.tif again.tif 'repeats'

# What must.
for option in '--samples 4' '--preset inferno' '--range 0,3' '--array v' '--array v:2' '--array c d' '--fovy 20' \
  '--eye 3,3,3'; do
  accept render cube.vtu -o other.tif --size 61x47 --pixel-type double ${option%% *} "${option#* }"
  differ one.tif other.tif "$option"
done
accept render cube.vtu -o black.png --size 40x30 --background 0,0,0
differ black.png cube.png background
accept render cube.vtu -o flat.png --array flat --size 40x30
warn '--background has no effect' render cube.vtu -o b.exr --size 9x9 --background 0,0,0
accept render cube.vtu -o b.exr --size 9x9 --background 0,0,0 --quiet

# Backgrounds by name and by digits.
for pair in white=1,1,1 BLACK=0,0,0 red=1,0,0 '#f00=1,0,0' '#00FF00=0,1,0' '#0000ffff=0,0,1,1' transparent=0,0,0,0 '#f000=1,0,0,0' \
  '#33669980=0.2,0.4,0.6,0.50196078431372548'; do
  accept render cube.vtu -o name.png --size 40x30 --bare --background "${pair%=*}"
  accept render cube.vtu -o numbers.png --size 40x30 --bare --background "${pair#*=}"
  same name.png numbers.png "background ${pair%=*}"
done
echo '{"input": "cube.vtu", "output": "name.png", "size": [40, 30], "background": "#33669980"}' >named.json
accept render --scene named.json
same name.png numbers.png 'a background in a scene'
warn 'has no alpha' render cube.vtu -o a.jpg --size 9x9 --background transparent
[ "$("$tetcast" render cube.vtu -o a.jpg --size 9x9 --background transparent 2>&1 | grep -c 'has no alpha')" = 1 ] || fail 'no alpha: said twice'
refuse 1 'has no alpha' render cube.vtu -o b.jpg --size 9x9 --background transparent --strict
refuse 1 'opaque background' render cube.vtu -o a.webp --size 9x9 --background '#fff8'
accept render cube.vtu -o a.webp --size 9x9

# Transfer functions: extinction 2 is the opacity 1 - exp(-2) of a unit; VTK's model takes opacity as extinction.
echo '{"color": [[0,1,0,0],[6,0,0,1]], "extinction": [[0,0],[6,0.5]]}' >extinction.json
echo '{"color": [[0,1,0,0],[6,0,0,1]], "opacity": [[0,0],[6,1]], "unit_distance": 2}' >opacity.json
accept render cube.vtu -o extinction.tif --size 40x30 --pixel-type double --transfer extinction.json
accept render cube.vtu -o opacity.tif --size 40x30 --pixel-type double --transfer opacity.json \
  --opacity-model vtk-unstructured
same extinction.tif opacity.tif 'opacity model'
accept render cube.vtu -o unit.tif --size 40x30 --pixel-type double --transfer opacity.json
differ unit.tif opacity.tif 'opacity model'
accept render cube.vtu -o ospray.tif --size 40x30 --pixel-type double --transfer opacity.json --opacity-model ospray
same ospray.tif opacity.tif 'opacity model'
warn '--opacity-model has no effect' \
  render cube.vtu -o a.png --size 9x9 --transfer extinction.json --opacity-model ospray

# A tolerance, and what the renderer says about the error: one more channel, and a number.
accept render cube.vtu -o exact.tif --size 61x47 --pixel-type double --tolerance 0 --integrator exact --stats exact.json
same one.tif exact.tif 'tolerance 0'
for tolerance in 0 1e-6 0.01; do
  accept render cube.vtu -o loose.exr --size 61x47 --tolerance $tolerance --channels error --pixel-type float --stats loose.json
  bound=$(sed -n 's/.*"error": \([0-9.e-]*\),.*/\1/p' loose.json)
  awk "BEGIN { exit !($bound > 0 && $bound <= $tolerance + 1e-6) }" || fail "error $bound at the tolerance $tolerance"
done
awk "BEGIN { exit !($bound > 1e-6) }" || fail "error $bound: the tolerance 0.01 is not used"
grep -q '"tolerance": 0.01,' loose.json || fail "tolerance: $(cat loose.json)"
accept render cube.vtu -o plain.exr --size 61x47 --pixel-type float
head -c 400 loose.exr | grep -qaw error || fail 'no channel "error"'
if head -c 400 plain.exr | grep -qaw error; then fail 'a channel "error" that nobody asked for'; fi
accept render cube.vtu -o a.tif --size 9x9 --channels error
accept render cube.vtu -o a.tif --size 9x9 --integrator midpoint:2 --stats other.json
grep -q '"error": null' other.json || fail 'another integrator states an error'

# Values that are not finite.
scalar='0 1 nan 2 3 4 6 5' vtu nan.vtu "$five_tetrahedra" 10
warn 'NaN' render nan.vtu -o nan.png --size 40x30
scalar='nan nan nan nan nan nan nan 0' vtu empty.vtu "$five_tetrahedra" 10
warn 'NaN' render empty.vtu --array s -o empty.png --size 40x30

# Cell data, constant in each and averaged.
accept render cube.vtu -o cells.tif --array 'c d' --size 61x47 --pixel-type double
accept render cube.vtu -o points.tif --array 'c d' --size 61x47 --pixel-type double --cell-to-point --save-scene points.json
differ cells.tif points.tif
accept render --scene points.json -o again.tif
same points.tif again.tif 'a scene with averages'
accept render cube.vtu -o same.tif --size 61x47 --pixel-type double --cell-to-point
same one.tif same.tif 'point data stay'
accept info cube.vtu --cell-to-point
contains 'cell +c d +float64 +\[0.5, 3.5\]' # of five tetrahedra, points of one among them

# Statistics.
accept render cube.vtu -o s.png --size 40x30 --samples 4 --repeat 3 --threads 2 --traversal faces --stats stats.json
output=$(cat stats.json)
for key in read_seconds prepare_seconds write_seconds; do contains "\"$key\": [0-9.e-]+,"; done
contains '"rays": 4800,'
contains '"segments": [1-9][0-9]*,'
contains '"peak_rss_bytes": [1-9][0-9]{6,},'
contains '"volume_bytes": [1-9][0-9]*,'
contains '"tetrahedra": 5,'
contains '"vertices": 8,'
contains '"threads": 2,'
contains '"isa": "[a-z0-9]+",'
contains '"precision": "double",'
contains '"traversal": "faces"'
for isa in scalar avx2; do
  accept render cube.vtu -o s.png --size 40x30 --isa $isa --stats stats.json
  output=$(cat stats.json)
  grep -qw avx2 /proc/cpuinfo || isa=scalar # what there is
  contains "\"isa\": \"$isa\","
done
accept render cube.vtu -o s.png --size 40x30 --samples 4 --repeat 3 --threads 2 --traversal faces --stats stats.json
times=$(tr -d ' \n' <stats.json | sed 's/.*"render_seconds":\[//; s/\].*//' | tr ',' '\n' | grep -c .)
[ "$times" = 3 ] || fail "$times render_seconds instead of 3"
"$tetcast" render cube.vtu -o s.png --size 9x9 --stats /dev/stdout | grep -q '"rays": 81' ||
  fail 'statistics to standard output'
refuse_stats() {
  "$tetcast" render cube.vtu -o s.png --size 9x9 "$@" 2>err && fail "exit code 0: $*"
  grep -q '^tetcast: error: .*/dev/full' err || fail "$(cat err): $*"
}
[ -c /dev/full ] && refuse_stats --stats /dev/full
rm -f err

# A full disk: files must not grow beyond a limit, in blocks of 1024 bytes.
rm -f ./*.json
for name in full.png full.exr full.tif full.jpg; do
  for blocks in 0 1 2 8; do
    echo old >$name
    (ulimit -f $blocks && "$tetcast" render cube.vtu -o $name --size 400x300 --array s) 2>&1 | cat >err
    [ "$(wc -l <err)" = 1 ] && grep -q "^tetcast: error: .*$name.*too large" err ||
      fail "$name at $blocks KiB: $(cat err)"
    [ "$(cat $name)" = old ] || fail "$name at $blocks KiB was changed"
  done
done
(ulimit -f 0 && "$tetcast" render cube.vtu -o full.png --size 9x9) 2>/dev/null && fail 'exit code 0 on a full disk'
(ulimit -f 1 && "$tetcast" render cube.vtu -o full.png --size 4x4 --save-scene scene.json) 2>&1 | cat >err
grep -q "^tetcast: error: .*scene.json.*too large" err || fail "scene.json: $(cat err)"
[ ! -e scene.json ] || fail 'scene.json is there'
find . -name '.*tetcast*' | grep . && fail 'temporary files are left'
if mkdir small && mount -t tmpfs -o size=16k tmpfs small 2>/dev/null; then
  refuse 1 'No space left' render cube.vtu -o small/a.tif --size 400x300
  umount small
fi
finish
