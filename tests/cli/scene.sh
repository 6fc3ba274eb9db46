# SPDX-License-Identifier: Apache-2.0
# A saved scene gives the same picture again, bit for bit, from wherever it is rendered.
. "$(dirname "$0")/lib.sh"
needs vtk openimageio
mkdir -p data scenes/deep
vtu data/cube.vtu "$five_tetrahedra" 10
echo '{"color": [[0.1,1,0,0],[2,0,0.3333333333333333,1],[2,1,1,1],[6,0,0,1]],
       "opacity": [[0.30000000000000004,0],[6,0.9]], "unit_distance": 0.7}' >data/t.json

round_trip() {
  accept render data/cube.vtu -o one.tif --size 53x37 --pixel-type double --save-scene scenes/deep/s.json "$@"
  (cd / && "$tetcast" render --scene "$work/scenes/deep/s.json") || fail "rendering the scene again: $*"
  same one.tif scenes/deep/one.tif "$*"
  accept render --scene scenes/deep/s.json -o two.tif --save-scene scenes/again.json
  same one.tif two.tif "$*"
  accept render --scene scenes/again.json -o three.tif
  same one.tif three.tif "$*"
}
round_trip
round_trip --samples 5 --traversal faces
round_trip --array v:1 --preset inferno --range 0.1,0.7
round_trip --array 'c d' --transfer data/t.json
round_trip --transfer data/t.json --opacity-model ospray
round_trip --integrator gauss:2
round_trip --tolerance 0.003 --channels error
output=$(cat scenes/deep/s.json)
contains '"tolerance": 0.003'
contains '"channels": "error"'
round_trip --eye 3,1.1,2 --fovy 17.3
round_trip --ortho 1.7 --up 0,0,1 --background 0.1,0.2,0.3,0.4 --quiet
round_trip --eye 0.5,0.5,0.5 --target 1,0.3,0.2 --up 1,1,1
output=$(cat scenes/deep/s.json)
for key in input output array transfer color extinction camera eye target up fovy size samples background traversal \
  pixel_type; do
  contains "\"$key\":"
done
contains '"input": "../../data/cube.vtu"'

gmsh_curved data/curved.msh
accept render data/curved.msh -o plain.tif --size 53x37 --pixel-type double
accept render data/curved.msh -o one.tif --size 53x37 --pixel-type double --subdivide 5 --save-scene scenes/deep/s.json
differ plain.tif one.tif
output=$(cat scenes/deep/s.json)
contains '"subdivide": 5'
(cd / && "$tetcast" render --scene "$work/scenes/deep/s.json") || fail "rendering the scene with curved cells again"
same one.tif scenes/deep/one.tif
refuse 2 'subdivide' render data/curved.msh -o one.tif --subdivide 17

# The picture is of the default pixel type, too.
accept render data/cube.vtu -o p.png --size 53x37 --save-scene p.json --background 0.2,0.1,0
cp p.png first.png
accept render --scene p.json
same p.png first.png
accept render --scene p.json -o p.exr

# Options win over the file; a scene's fovy gives way to --ortho, its transfer function to --preset.
accept render --scene p.json -o q.png --size 20x20
accept render data/cube.vtu -o r.png --size 20x20 --background 0.2,0.1,0
differ q.png p.png
accept render --scene p.json --ortho 1.5 -o q.png
accept render data/cube.vtu -o r.png --size 53x37 --background 0.2,0.1,0 --ortho 1.5
same q.png r.png '--ortho over fovy'
accept render --scene p.json --preset inferno -o q.png
accept render data/cube.vtu -o r.png --size 53x37 --background 0.2,0.1,0 --preset inferno
same q.png r.png '--preset over transfer'
accept render --scene p.json --transfer data/t.json -o q.png
accept render data/cube.vtu -o r.png --size 53x37 --background 0.2,0.1,0 --transfer data/t.json
same q.png r.png '--transfer over transfer'

# Together they must make sense, wherever each comes from.
accept render data/cube.vtu -o e.exr --size 9x9 --channels error --tolerance 1e-3 --save-scene e.json
refuse 1 'only .exr and .tif' render --scene e.json -o q.png
refuse 1 'only the exact integrator' render --scene e.json --integrator midpoint:3
echo '{"input": "data/cube.vtu", "refine": true}' >r.json
refuse 1 "unknown key 'refine'" render --scene r.json

# Written by hand, with paths relative to the file, in either spelling.
cat >scenes/hand.json <<END
{"input": "../data/cube.vtu", "output": "hand.tif", "array": "s", "transfer": "../data/t.json",
 "camera": {"eye": [3, 2, 5]},
 "size": [40, 30], "samples": 2, "background": [1, 1, 1], "pixel_type": "double", "threads": 1, "repeat": 2,
 "stats": "stats.json", "quiet": true, "traversal": "shell", "opacity-model": "unit-distance"}
END
accept render --scene scenes/hand.json
exists scenes/hand.tif scenes/stats.json
accept render data/cube.vtu --transfer data/t.json --eye 3,2,5 --size 40x30 --samples 2 --pixel-type double -o hand.tif
same hand.tif scenes/hand.tif
finish
