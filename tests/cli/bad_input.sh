# SPDX-License-Identifier: Apache-2.0
# Each kind of bad input: exit code 1, one line that says what and where, no file.
. "$(dirname "$0")/lib.sh"
needs vtk openimageio

vtu good.vtu "$five_tetrahedra" 10
render() { refuse 1 "$@" -o out.png --size 20x20; }

# Files that are no volume.
refuse 1 'missing.vtu' render missing.vtu
refuse 1 'missing.vtu' info missing.vtu
mkdir folder.vtu
: >empty.vtu
echo 'no mesh at all' >text.vtu
echo 'no mesh at all' >text.vtk
head -c 900 good.vtu >truncated.vtu
vtu triangles.vtu '0 1 2;4 5 6' 5
vtu none.vtu '' 10
vtu range.vtu '0 1 3 4;1 2 3 8' 10
vtu negative.vtu '0 1 3 4;1 2 3 -1' 10
for file in folder empty text truncated triangles none range negative; do
  render "$file.vtu" render "$file.vtu"
  refuse 1 "$file.vtu" info "$file.vtu"
done
render text.vtk render text.vtk

# Arrays.
for array in nope s:1 v:3 v:-1 v:w v:xx v: v:x:y v:point:cell v:cell s:cell 'c d:point' ''; do
  [ -n "$array" ] && render v render good.vtu --array "$array"
done
render 'c d' render good.vtu --array nope
render "did you mean 'flat'?" render good.vtu --array falt
render "did you mean 'flat'?" render good.vtu --array falt:mag
render "did you mean 'c d'?" render good.vtu --array 'cd'
render "there are: 0 to 2 (x, y, z) and mag" render good.vtu --array v:mga
refuse 1 "did you mean 'flat'?" converge good.vtu -o report --array fltat --no-plots
refuse 2 '--array' render good.vtu --array ''

# Transfer functions.
bad_transfer() {
  printf '%s' "$2" >t.json
  render "$1" render good.vtu --transfer t.json
  printf '{"input": "good.vtu", "transfer": %s}' "$2" >scene.json
  refuse 1 '' render --scene scene.json -o out.png
}
color='"color": [[0,1,0,0],[1,0,0,1]]'
bad_transfer t.json ''
bad_transfer t.json:1 '{'
bad_transfer t.json:1 "{$color, \"extinction\": [[0,1],[1,NaN]]}"
bad_transfer t.json:1 "{$color, \"extinction\": [[0,1],[1,1e999]]}"
bad_transfer t.json:1 "{$color, $color, \"extinction\": [[0,1]]}"
bad_transfer 'JSON object' '[]'
bad_transfer '"color"' '{"extinction": [[0,1]]}'
bad_transfer '"extinction"' "{$color}"
bad_transfer 'either' "{$color, \"extinction\": [[0,1]], \"opacity\": [[0,1]]}"
bad_transfer 'unit_distance' "{$color, \"extinction\": [[0,1]], \"unit_distance\": 2}"
bad_transfer 'unit_distance' "{$color, \"opacity\": [[0,1]], \"unit_distance\": \"2\"}"
bad_transfer 't.json: ' "{$color, \"opacity\": [[0,1]], \"unit_distance\": 0}"
bad_transfer "unknown key 'opcity'; did you mean 'opacity'?" "{$color, \"opcity\": [[0,1]]}"
bad_transfer 'color' '{"color": [], "extinction": [[0,1]]}'
bad_transfer 'color[1]' '{"color": [[0,1,0,0],[1,0,0]], "extinction": [[0,1]]}'
bad_transfer 'color[0]' '{"color": [[0,1,0,0,1]], "extinction": [[0,1]]}'
bad_transfer 'color[0]' '{"color": [0,1,0,0], "extinction": [[0,1]]}'
bad_transfer 'extinction[1]' "{$color, \"extinction\": [[0,1],[1,\"x\"]]}"
bad_transfer 't.json: ' '{"color": [[1,1,0,0],[0,0,0,1]], "extinction": [[0,1]]}'
bad_transfer 't.json: ' '{"color": [[0,-1,0,0],[1,0,0,1]], "extinction": [[0,1]]}'
bad_transfer 't.json: ' "{$color, \"extinction\": [[1,1],[0,1]]}"
bad_transfer 't.json: ' "{$color, \"extinction\": [[0,-1]]}"
bad_transfer 't.json: ' "{$color, \"extinction\": [[0,1],[0,2],[0,3]]}"
bad_transfer 't.json: ' "{$color, \"opacity\": [[0,1.5]]}"
render missing.json render good.vtu --transfer missing.json
render folder.vtu render good.vtu --transfer folder.vtu

# Scene files.
bad_scene() {
  printf '%s' "$2" >scene.json
  refuse 1 "$1" render --scene scene.json -o out.png
}
bad_scene scene.json:1 ''
bad_scene scene.json:2 '{"input": "good.vtu",
}'
bad_scene scene.json:1 '{"input": "good.vtu", "input": "good.vtu"}'
bad_scene 'JSON object' '[1]'
bad_scene "unknown key 'inptu'; did you mean 'input'?" '{"inptu": "good.vtu"}'
bad_scene "unknown key 'eye'" '{"input": "good.vtu", "eye": [0,0,1]}'
bad_scene "unknown key 'camra'; did you mean 'camera'?" '{"input": "good.vtu", "camra": {}}'
bad_scene "unknown key 'camera.tragte'; did you mean 'target'?" '{"input": "good.vtu", "camera": {"tragte": [0,0,1]}}'
bad_scene "unknown key 'camera.size'" '{"input": "good.vtu", "camera": {"size": [1,1]}}'
bad_scene "unknown key 'save_scene'" '{"input": "good.vtu", "save_scene": "x.json"}'
bad_scene 'input: ' '{"input": 3}'
bad_scene 'input: ' '{"input": ""}'
bad_scene 'camera: ' '{"input": "good.vtu", "camera": 3}'
bad_scene 'camera.eye: ' '{"input": "good.vtu", "camera": {"eye": [1,2]}}'
bad_scene 'camera.eye: ' '{"input": "good.vtu", "camera": {"eye": [1,2,"3"]}}'
bad_scene 'camera.fovy: ' '{"input": "good.vtu", "camera": {"fovy": 180}}'
bad_scene 'exclude each other' '{"input": "good.vtu", "camera": {"fovy": 30, "ortho": 1}}'
bad_scene 'exclude each other' '{"input": "good.vtu", "preset": "viridis", "transfer": "t.json"}'
bad_scene 'same point' '{"input": "good.vtu", "camera": {"eye": [1,2,3], "target": [1,2,3]}}'
bad_scene 'twice' '{"input": "good.vtu", "pixel_type": "uint8", "pixel-type": "uint8"}'
bad_scene 'size: ' '{"input": "good.vtu", "size": [0, 10]}'
bad_scene 'size: ' '{"input": "good.vtu", "size": [10.5, 10]}'
bad_scene 'size: ' '{"input": "good.vtu", "size": "10x10"}'
bad_scene 'quiet: ' '{"input": "good.vtu", "quiet": 1}'
bad_scene 'samples: ' '{"input": "good.vtu", "samples": true}'
bad_scene 'preset: ' '{"input": "good.vtu", "preset": "nope"}'
bad_scene 'transfer: ' '{"input": "good.vtu", "transfer": [1]}'
bad_scene 'missing.vtu' '{"input": "missing.vtu"}'
refuse 1 'nope.json' render --scene nope.json
printf '{"size": [10,10]}' >scene.json
refuse 2 'no input' render --scene scene.json

# Nothing that can be known beforehand waits for the mesh: the input does not exist either.
refuse 1 'folder does not exist' render missing.vtu -o no/out.png
refuse 1 '.foo' render missing.vtu -o out.foo
refuse 1 'type half' render missing.vtu -o out.png --pixel-type half
refuse 1 'type double' render missing.vtu -o out.exr --pixel-type double
refuse 1 'folder does not exist' render missing.vtu -o out.png --stats no/stats.json
refuse 1 'folder does not exist' render missing.vtu -o out.png --save-scene no/scene.json
refuse 1 'irectory' render missing.vtu -o out.png --stats folder.vtu

# What is found out about the mesh meanwhile is not told before.
scalar='0 1 nan 2 3 4 6 5' vtu warning.vtu "$five_tetrahedra" 10
for file in missing text warning; do refuse 1 'folder does not exist' render $file.vtu -o no/out.png; done
finish
