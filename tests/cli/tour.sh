# SPDX-License-Identifier: Apache-2.0
# --orbit and --dolly: each picture is that from a place which is computed here.
. "$(dirname "$0")/lib.sh"
needs vtk openimageio
vtu cube.vtu "$five_tetrahedra" 10
small='--size 40x30'

# place EYE TARGET UP DEGREES SHARE: the eye turned, by a matrix in the frame of the axis, and moved.
place() {
  python3 - "$@" <<'END'
import math, sys
eye, target, up = ([float(x) for x in text.split(",")] for text in sys.argv[1:4])
angle, share = math.radians(float(sys.argv[4])), float(sys.argv[5])
dot = lambda a, b: sum(x * y for x, y in zip(a, b))
cross = lambda a, b: [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
unit = lambda a: [x / math.sqrt(dot(a, a)) for x in a]
arm = [(e - t) * share for e, t in zip(eye, target)]
axis = unit(up)
first = unit([a - dot(arm, axis) * u for a, u in zip(arm, axis)]) # across the axis, to the eye
second = cross(axis, first)
radius = dot(arm, first)
print(",".join("%.17g" % (t + dot(arm, axis) * u + radius * (math.cos(angle) * f + math.sin(angle) * s))
               for t, u, f, s in zip(target, axis, first, second)))
END
}

accept render cube.vtu $small -o plain.png --save-scene plain.json
accept render cube.vtu $small --orbit 6 -o o.###.png
exists o.000.png o.001.png o.002.png o.003.png o.004.png o.005.png
[ ! -e o.006.png ] || fail 'a picture too many'
same plain.png o.000.png 'the first picture'
differ o.000.png o.003.png
of_camera() { tr -d ' \n' <plain.json | sed "s/.*\"$1\":\[\([^]]*\)\].*/\1/"; }
eye=$(of_camera eye) target=$(of_camera target) up=$(of_camera up)
for i in 1 2 3 4 5; do
  accept render cube.vtu $small --eye "$(place "$eye" "$target" "$up" $((60 * i)) 1)" --target "$target" --up "$up" -o k.png
  same k.png o.00$i.png "picture $i"
done
# By an angle, with an axis that is not perpendicular to the view, at a light of the world's.
skew='--eye 2,3,4 --target 0.4,0.6,0.5 --isosurface 2.5 --light 1,2,1'
accept render cube.vtu $small $skew --up 0.3,-1,4 --orbit 4:-100 -o s.%02d.png
for i in 0 1 2 3; do
  accept render cube.vtu $small $skew --up 0.3,-1,4 -o k.png --eye "$(place 2,3,4 0.4,0.6,0.5 0.3,-1,4 $((-25 * i)) 1)"
  same k.png s.0$i.png "picture $i of an angle"
done
# Nearer, and away; a view that is parallel.
accept render cube.vtu $small --eye 2,3,4 --target 0.5,0.5,0.5 --dolly 3:4 -o d.png --save-scene d.json --stats d.stats
accept render cube.vtu $small --eye 2,3,4 --target 0.5,0.5,0.5 --dolly 3:0.25 -o away.png
accept render cube.vtu $small --eye 2,3,4 --target 0.5,0.5,0.5 --dolly 1 -o lone.png
share=(1 0.5 0.25) back=(1 2 4)
for i in 0 1 2; do
  accept render cube.vtu $small --eye "$(place 2,3,4 0.5,0.5,0.5 0,1,0 0 ${share[i]})" --target 0.5,0.5,0.5 -o k.png
  same k.png d.000$i.png "picture $i of a dolly"
  accept render cube.vtu $small --eye "$(place 2,3,4 0.5,0.5,0.5 0,1,0 0 ${back[i]})" --target 0.5,0.5,0.5 -o k.png
  same k.png away.000$i.png "picture $i of a dolly back"
done
same lone.0000.png d.0000.png
accept render cube.vtu $small --ortho 2 --eye 2,3,4 --target 0.5,0.5,0.5 --dolly 2:4 -o p.#####.png
accept render cube.vtu $small --ortho 0.5 --eye "$(place 2,3,4 0.5,0.5,0.5 0,1,0 0 0.25)" --target 0.5,0.5,0.5 -o k.png
same k.png p.00001.png 'a parallel view'

# Statistics and scenes; prepared once.
[ "$(grep -c '"frame": ' d.stats)" = 3 ] && [ "$(grep -c '"write_seconds": [0-9.e-]*[1-9]' d.stats)" = 3 ] || fail "$(cat d.stats)"
[ "$(grep '"prepare_seconds"' d.stats | sort -u | wc -l)" = 1 ] || fail "prepared anew: $(grep prepare d.stats)"
grep -q '"dolly": "3:4"' d.json || fail "$(cat d.json)"
mkdir again
cp d.json again/
sed -i 's|"input": "|"input": "../|' again/d.json
accept render --scene again/d.json
for i in 0 1 2; do same d.000$i.png again/d.000$i.png "picture $i of a scene"; done
accept render --scene d.json --orbit 2 -o turned.##.png # excludes the scene's
exists turned.00.png turned.01.png
[ ! -e turned.02.png ] || fail 'the dolly of the scene'

# Every picture with a range of its own, where it must be so.
accept render cube.vtu $small --blend additive --range step --orbit 2:90 -o b.#.png
refuse 2 '--range LO,HI or --range step' render cube.vtu $small --blend additive --orbit 2 -o bad.png

# A step of a series.
sed 's/format="ascii">0 1 3 2 3 4 6 5/format="ascii">3 1 2 2 3 4 0 5/' cube.vtu >cube_2.vtu
cp cube.vtu cube_1.vtu
accept render cube_1.vtu cube_2.vtu --time 1 $small --orbit 2 -o t.##.png
accept render cube_2.vtu $small --orbit 2 -o u.##.png
same t.01.png u.01.png 'a step'

# Kept.
touch -d '2001-01-01' o.00*.png
cp o.002.png saved.png
rm o.002.png
accept render cube.vtu $small --orbit 6 -o o.###.png --resume --stats o.stats
same o.002.png saved.png
[ "$(grep -c '"kept": true' o.stats)" = 5 ] || fail "$(cat o.stats)"
[ "$(find . -name 'o.00*' ! -newermt 2002-01-01 | wc -l)" = 5 ] || fail 'pictures were replaced'
rm o.002.png
refuse 1 'is not the picture that would be made now' render cube.vtu $small --orbit 6:300 --resume -o o.###.png --preset inferno

# What can't be written ends the run, and what was made stays.
mkdir w.02.png
"$tetcast" render cube.vtu $small --orbit 5 -o w.##.png 2>"$work.err" && fail 'a folder was written to'
grep -qE "^tetcast: error: (frame 2: )?cannot write image 'w.02.png'" "$work.err" || fail "$(cat "$work.err")"
exists w.00.png w.01.png
[ ! -e w.04.png ] || fail 'went on after an error'

# Stopped: what is there is whole.
env --default-signal=INT "$tetcast" render cube.vtu --size 600x600 --samples 36 --orbit 200 -o slow.###.png 2>"$work.err" &
pid=$!
for _ in $(seq 600); do
  [ ! -e slow.000.png ] || break
  sleep 0.05
done
kill -s INT "$pid"
wait "$pid"
code=$?
[ "$code" = 130 ] && [ "$(cat "$work.err")" = 'tetcast: note: draws point array s; --array chooses another: v, flat, c d
tetcast: error: interrupted' ] || fail "exit code $code: $(cat "$work.err")"
[ -z "$(find . -name '.tetcast*')" ] || fail "files are left: $(files)"
[ ! -e slow.199.png ] || fail 'was not stopped'

for text in 0 -3 1.5 x 3:x 3:4:5 '' 2000000; do
  refuse 2 'expected N[:DEGREES]' render cube.vtu --orbit "$text" -o bad.png
  refuse 2 'expected N[:FACTOR]' render cube.vtu --dolly "$text" -o bad.png
done
refuse 2 'expected N[:FACTOR]' render cube.vtu --dolly 3:0 -o bad.png
refuse 2 '--dolly and --orbit exclude each other' render cube.vtu --orbit 3 --dolly 3 -o bad.png
refuse 2 'of one step alone; --time STEP chooses it' render cube.vtu --time all --orbit 3 -o bad.png
refuse 2 'of one step alone; --time STEP chooses it' render cube_1.vtu cube_2.vtu --orbit 3 -o bad.png
refuse 2 'not with --range series' render cube.vtu --range series --orbit 3 -o bad.png
refuse 2 '--deep: not possible with --orbit or --dolly' render cube.vtu --deep --orbit 3 -o bad.exr
refuse 2 '--stop-depth: not possible with --orbit or --dolly' render cube.vtu --stop-depth x.exr --orbit 3 -o bad.png
refuse 2 "--orbit" converge cube.vtu -o report --orbit 3
finish
