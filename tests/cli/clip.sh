# SPDX-License-Identifier: Apache-2.0
# tetcast render --clip, --clip-box and --stop-depth.
. "$(dirname "$0")/lib.sh"
needs vtk openimageio
states() { # FILE TEXT
  checks=$((checks + 1))
  tr -d ' \n' <"$1" | grep -qF -- "$2" || fail "no '$2' in $1: $(cat "$1")"
}
vtu cube.vtu "$five_tetrahedra" 10 # s = x + 2 y + 3 z
down='--eye 0.5,0.5,1.5 --ortho 1.2 --size 41x31 --array s --bare'

# A half of the cube has the largest values that it has: x + 2 y + 3 z with z at most 1/2.
accept render cube.vtu -o whole.png $down --blend maximum --range 0,6
accept render cube.vtu -o half.png $down --blend maximum --range 0,6 --clip 0,0,-1,-0.5
accept render cube.vtu -o values.png $down --blend maximum --range 1.5,7.5
same half.png values.png 'the largest value is less by 3/2'
differ whole.png half.png clip
accept render cube.vtu -o beside.png $down --blend maximum --range 0,6 --clip 1,0,0,-3 --clip 0,-2,0,-9
same whole.png beside.png 'planes beside the mesh'

# Boxes are six half-spaces, options add up, and all of it goes with every way to render.
planes='--clip 1,0,0,0.2 --clip -2,0,0,-1.6 --clip 0,1,0,-4 --clip 0,-1,0,-0.75 --clip 0,0,1,0.25 --clip 0,0,-1,-0.5'
accept render cube.vtu -o box.png $down --clip-box 0.2,0.8,-4,0.75,0.25,0.5
accept render cube.vtu -o planes.png $down $planes
same box.png planes.png 'a box by planes'
accept render cube.vtu -o both.png $down --clip-box 0.2,0.8,-4,2,0.25,0.5 --clip 0,-1,0,-0.75
same box.png both.png 'a box and a plane'
for way in '--traversal faces' '--isa scalar' '--threads 1' '--tolerance 1e-6'; do
  accept render cube.vtu -o other.png $down $planes $way
  same box.png other.png "$way"
done
accept render cube.vtu -o direct.exr --eye 0.5,0.5,1.5 --ortho 1.2 --size 41x31 --extinction s --emission s --clip 1,1,1,1.1 \
  --channels error,path_length
accept render cube.vtu -o error.exr $down --clip 1,1,1,1.1 --channels error --samples 4
accept render cube.vtu -o cells.png --array 'c d' --clip 1,1,1,1.1

# In any unit.
vtu large.vtu "$five_tetrahedra" 10 "${cube//1/1e30}"
accept render large.vtu -o large.png --array s --eye 0.5e30,0.5e30,1.5e30 --ortho 1.2e30 --size 41x31 --bare \
  --clip-box 0.2e30,0.8e30,-4e30,0.75e30,0.25e30,0.5e30
same box.png large.png unit

# A scene keeps it; what the command line says takes its place.
accept render cube.vtu -o saved.png $down $planes --save-scene planes.json
accept render --scene planes.json -o again.png
same saved.png again.png scene
accept render cube.vtu -o saved.png $down --clip-box 0.2,0.8,-4,0.75,0.25,0.5 --save-scene box.json
states box.json '"clip_box":[0.2'
accept render --scene box.json -o again.png
same box.png again.png 'scene with a box'
accept render --scene planes.json -o again.png --clip 0,0,1,0.5
accept render cube.vtu -o one.png $down --clip 0,0,1,0.5
same one.png again.png 'the option takes the place of all'
sed 's/"clip_box": \[[^]]*\]/"clip": [0, 0, 1, 0.5]/' box.json >single.json
accept render --scene single.json -o again.png
same one.png again.png 'a single half-space in a scene'
for faulty in '[0, 0, 0, 1]' '[1, 2, 3]' '[[1, 0, 0, 0], [1, 0]]' '"x"' '[]' 'true'; do
  sed "s/\"clip_box\": \[[^]]*\]/\"clip\": $faulty/" box.json >faulty.json
  refuse 1 'faulty.json: clip: expected four numbers' render --scene faulty.json -o no.png
done

# What leaves nothing says so.
warn 'the picture shows nothing: the clip leaves nothing of what the camera sees' render cube.vtu -o none.png $down --clip 0,0,1,3
warn 'the clip leaves nothing' render cube.vtu -o none.png $down --clip 1,0,0,0.6 --clip -1,0,0,-0.4
warn 'the clip leaves nothing' render cube.vtu -o none.png --size 20x20 --extinction s --clip 0,0,1,3
warn 'the clip leaves nothing' render cube.vtu -o none.png $down --blend average --clip-box 0.55,0.55,0,1,0,1
refuse 1 'the clip leaves nothing' render cube.vtu -o strict.png $down --clip 0,0,1,3 --strict
warn 'looks away' render cube.vtu -o none.png --array s --clip 0,0,1,0.5 --eye 5,5,5 --target 9,9,9 --size 20x20

# Depths from a file: of transmittance 1, at which the rays stop one unit of length from the eye.
scalar='0 0 0 0 0 0 0 0' vtu clear.vtu "$five_tetrahedra" 10
for file in depth.exr depth.tif; do
  "$tetcast" render clear.vtu -o $file --eye 0.5,0.5,1.5 --ortho 1.2 --size 41x31 --extinction s --groups 2>/dev/null ||
    fail "no $file"
  accept render cube.vtu -o stopped.png $down --stop-depth $file --save-scene stopped.json
  same one.png stopped.png "stopped by $file"
done
states stopped.json '"stop_depth":"depth.tif"'
accept render --scene stopped.json -o again.png
same one.png again.png 'scene with depths'
warn 'beyond the depths of --stop-depth' render cube.vtu -o far.png --array s --eye 0.5,0.5,9 --size 41x31 --stop-depth depth.exr
refuse 1 'it has 41 x 31 pixels, the picture 40 x 31' render cube.vtu -o no.png --size 40x31 --stop-depth depth.exr
refuse 1 'its pixels are uint8' render cube.vtu -o no.png --size 41x31 --stop-depth box.png
refuse 1 "cannot read depths from 'nowhere.exr'" render cube.vtu -o no.png --stop-depth nowhere.exr
refuse 1 "cannot read depths from 'cube.vtu'" render cube.vtu -o no.png --stop-depth cube.vtu
refuse 2 'would replace --stop-depth' render cube.vtu -o depth.exr $down --stop-depth depth.exr

# What is not possible.
refuse 2 'expected four numbers nx,ny,nz,d' render cube.vtu --clip 1,0,0
refuse 2 'expected four numbers nx,ny,nz,d' render cube.vtu --clip 0,0,0,1
refuse 2 'expected four numbers nx,ny,nz,d' render cube.vtu --clip 1,0,0,inf
refuse 2 'the first of each pair not above the second' render cube.vtu --clip-box 1,0,0,1,0,1
refuse 2 'expected six numbers' render cube.vtu --clip-box 0,1,0,1
refuse 2 'did you mean --clip-box' render cube.vtu --clip-bx 0,1,0,1,0,1
refuse 2 '--stop-depth' converge cube.vtu -o report --stop-depth depth.exr

# The report's reference knows of it.
accept converge cube.vtu -o report --array s --clip 1,1,1,1.1 --size 16x12 --repeat 1 --no-plots --quiet
grep -q 'brute' report/report.md || fail 'no check against brute force'
finish
