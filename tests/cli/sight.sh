# SPDX-License-Identifier: Apache-2.0
# A picture in which nothing can be seen, or a wall, is said to be one, with the cause, and is an error with --strict; any
# other is not.
. "$(dirname "$0")/lib.sh"
needs vtk openimageio
scaled() { # FILE EDGE: the cube with edges of this length
  vtu "$1" "$five_tetrahedra" 10 "0 0 0  $2 0 0  $2 $2 0  0 $2 0  0 0 $2  $2 0 $2  $2 $2 $2  0 $2 $2"
}
scaled cube.vtu 1
scaled tiny.vtu 1e-9
scaled large.vtu 1e9
transfer() { echo "{\"color\": [[0,0.5,0.1,0.2]], $2}" >"$1.json"; }
transfer faint '"extinction": [[0,1e-9],[6,1e-4]]'
transfer opacity '"opacity": [[0,0],[6,0.8]], "unit_distance": 1'
transfer wall '"extinction": [[0,1e5]]'
transfer late '"extinction": [[5.5,0],[5.5,1e6]]'
transfer narrow '"extinction": [[10,0],[11,1],[12,0]]'
transfer none '"extinction": [[0,0]]'
transfer soft '"extinction": [[0,1]]'
echo '{"color": [[0,1,1,1]], "extinction": [[0,2]]}' >white.json
small='--size 64x48'

# says TEXT ARGUMENTS…: one warning, which is an error if it is to be, and then nothing is written.
says() {
  local text=$1
  shift
  checks=$((checks + 1))
  rm -f a.png
  "$tetcast" render "$@" -o a.png $small 2>"$work.err" || fail "exit code $?: $*"
  hear
  [[ $said = *$'\n' && ${said%$'\n'} != *$'\n'* ]] || fail "not one line: $said: $*"
  [[ $said = *'tetcast: warning: '*"$text"* ]] || fail "no warning '$text' in '$said': $*"
  exists a.png
  rm -f a.png
  refuse 1 "$text" render "$@" -o a.png $small --strict
}
nothing='the picture shows nothing: '

# Nothing of the range is in the data.
says "${nothing}the extinction is 0 for all values of array s, which go from 0 to 6; only values above 100" cube.vtu --range 100,200
says "${nothing}the extinction is 0 for all values of array s, which go from 0 to 6; only values between 10 and 12" \
  cube.vtu --transfer narrow.json
says "${nothing}the extinction is 0 for all values of array s, which go from 0 to 6; it is 0 for every value" \
  cube.vtu --transfer none.json
# The camera looks elsewhere.
says "${nothing}the mesh lies behind the camera" cube.vtu --eye 0,0,5 --target 0,0,9
says "${nothing}the camera looks past the mesh" cube.vtu --eye 0,0,5 --target 0,9,5
says "${nothing}the camera looks past the mesh" cube.vtu --eye 0,0,5 --target 5,0,0 --ortho 1
says "${nothing}the mesh falls between the rays" cube.vtu --eye 0,0,1e5 --target 0,0,0
# The extinction is small for the mesh, or the unit distance large.
says "${nothing}alpha is " cube.vtu --transfer faint.json
says "is too small for a mesh that measures 1.73e-09, or the unit_distance of the opacity is too large" tiny.vtu --transfer opacity.json
# Everything is NaN, or touches it.
scalar='nan nan nan nan nan nan nan 0' vtu nan.vtu "$five_tetrahedra" 10
scalar='0 nan 1 nan 2 3 nan 4' vtu touched.vtu "$five_tetrahedra" 10 # one value of each cell
for file in nan touched; do
  warn "${nothing}all cells are transparent, as they touch values of array s that are NaN" render $file.vtu --array s -o a.png $small
  warn 'values are NaN or infinite' render $file.vtu --array s -o a.png $small
done
# It is there, but of the background's colour.
says "${nothing}what is there has the colours of the background" cube.vtu --transfer white.json --background white
accept render cube.vtu -o a.png $small --transfer white.json --background black
accept render cube.vtu -o a.png $small --transfer white.json --quiet
accept render cube.vtu -o a.png $small --transfer white.json --background transparent
accept render cube.vtu -o a.exr $small --transfer white.json
# What the camera sees has no extinction, though other parts have. Its eye is in the corner of the smallest value.
says "${nothing}no value that the camera sees has an extinction" cube.vtu --transfer late.json --eye 0.05,0.05,0.05 --target -1,-1,-1

# A wall: also where the numbers are extreme; not where what is in front is transparent, or something is seen inside.
says 'the picture is a wall: ' cube.vtu --transfer wall.json
says 'the picture is a wall: ' cube.vtu --transfer wall.json --ortho 3 --eye 4,3,5
says 'the picture is a wall: ' large.vtu --transfer wall.json
for options in '--transfer late.json --eye -3,-2,-4' '--transfer wall.json --eye 0.5,0.5,0.5 --target 1,0.4,0.3' '--transfer soft.json' '' \
  '--preset inferno --range 0,3 --ortho 3' '--tolerance 0.1' '--extinction s --background gray'; do
  # shellcheck disable=SC2086  # a list of words
  accept render cube.vtu -o a.png $small $options
done
accept render large.vtu -o a.png $small

# Coefficients: what integer pixels show. Floating-point ones hold data, which may be as small as they like.
scalar='1e-9 1e-9 1e-9 1e-9 1e-9 1e-9 1e-9 1e-9' vtu thin.vtu "$five_tetrahedra" 10
scalar='1e6 1e6 1e6 1e6 1e6 1e6 1e6 1e6' vtu thick.vtu "$five_tetrahedra" 10
says "${nothing}what the camera sees has no extinction and no emission to speak of" thin.vtu --extinction s
says "${nothing}the mesh lies behind the camera" thick.vtu --extinction s --eye 0,0,5 --target 0,0,9
says 'the picture is a wall' thick.vtu --extinction s
accept render thin.vtu -o a.tif $small --extinction s --channels optical_depth
accept render thick.vtu -o a.tif $small --extinction s --groups
warn "${nothing}the mesh lies behind the camera" render thick.vtu -o a.tif $small --extinction s --groups --eye 0,0,5 --target 0,0,9

# Of a series, a step may be empty; not all of them.
scalar='0 0 0 0 0 0 0 0' vtu step_1.vtu "$five_tetrahedra" 10
cp cube.vtu step_2.vtu
accept render step_1.vtu step_2.vtu -o s.##.png $small --range 0,6
warn "of all steps: ${nothing}the extinction is 0" render step_1.vtu step_2.vtu -o s.##.png $small --range 10,60
"$tetcast" render step_1.vtu step_2.vtu -o s.##.png $small --range 10,60 --strict 2>/dev/null && fail 'exit code 0 with --strict'

# Colours above 1 are white: in a transfer function, and in what comes of it.
echo '{"color": [[0,255,100,20],[6,0,10,200]], "extinction": [[0,1]]}' >bytes.json
warn 'are they from 0 to 255? Divide them by 255' render cube.vtu -o a.png $small --transfer bytes.json
warn 'above 1 all is white in integer pixels' render cube.vtu -o a.png $small --transfer bytes.json
warn 'values up to 255' render cube.vtu -o a.exr $small --transfer bytes.json
"$tetcast" render cube.vtu -o a.exr $small --transfer bytes.json 2>&1 | grep -q 'all is white' && fail '.exr clips nothing'
echo '{"color": [[0,1,1,1],[6,0,1,0.5]], "extinction": [[0,1e4]]}' >unit.json
"$tetcast" render cube.vtu -o a.png $small --transfer unit.json 2>&1 | grep -E '255|white' && fail 'colours up to 1 do not clip'
echo '{"input": "cube.vtu", "output": "a.png", "emission": "s", "size": [64, 48]}' >scene.json
warn 'above 1 all is white in integer pixels' render --scene scene.json
finish
