# SPDX-License-Identifier: Apache-2.0
# How a camera that is given in part is completed, as the saved scene states it.
. "$(dirname "$0")/lib.sh"
needs vtk openimageio
vtu cube.vtu "$five_tetrahedra" 10

# camera ARGUMENTS…: the camera as one line, numbers rounded.
camera() {
  accept render "${file:-cube.vtu}" -o a.png --size "${size:-20x20}" --save-scene s.json "$@"
  output=$(tr -d ' \n' <s.json | sed 's/.*"camera"://; s/}.*//' | sed -E 's/([0-9]\.[0-9]{4})[0-9]*/\1/g')
}
camera
contains '"eye":\[0.5,0.5,3.8460\],"target":\[0.5,0.5,0.5\],"up":\[0.0,1.0,0.0\],"fovy":(30.0|29.9999)'
camera --eye 5,5,5
contains '"eye":\[5.0,5.0,5.0\],"target":\[0.5,0.5,0.5\],"up":\[0.0,1.0,0.0\]'
camera --eye 0.5,7,0.5
contains '"target":\[0.5,0.5,0.5\],"up":\[0.0,0.0,1.0\]'
camera --eye 0.5,0.5,0.5
contains '"eye":\[0.5,0.5,0.5\],"target":\[0.5,0.5,-'
camera --target 1,2,3
contains '"eye":\[1.0,2.0,6.3460\],"target":\[1.0,2.0,3.0\]'
camera --up 0,0,2
contains '"eye":\[0.5,-2.8460,0.5\],"target":\[0.5,0.5,0.5\],"up":\[0.0,0.0,2.0\]'
camera --fovy 90
contains '"eye":\[0.5,0.5,1.7247\].*"fovy":90.0'
camera --ortho 2.5
contains '"eye":\[0.5,0.5,3.8460\].*"ortho":2.5'
camera --fovy 30
contains '"eye":\[0.5,0.5,3.8460\]'
size=10x20 camera --fovy 30 # half as wide as high: farther away
contains '"eye":\[0.5,0.5,7.0218'
refuse 2 'parallel' render cube.vtu -o b.png --eye 5,0.5,0.5 --up 1,0,0
echo '{"input": "cube.vtu", "camera": {"eye": [5,0.5,0.5], "up": [1,0,0]}}' >parallel.json
refuse 1 'parallel' render --scene parallel.json -o b.png

# A flat mesh, or a long one, is seen from a side where it has an area.
scaled() { # FILE X Y Z: the cube with these edges
  vtu "$1" "$five_tetrahedra" 10 "0 0 0  $2 0 0  $2 $3 0  0 $3 0  0 0 $4  $2 0 $4  $2 $3 $4  0 $3 $4"
}
scaled flat_x.vtu 0.01 1 1
scaled flat_y.vtu 1 0.01 1
scaled flat_z.vtu 1 1 0.01
scaled long_z.vtu 0.1 0.1 4
scaled half.vtu 1 0.2 1
file=flat_z.vtu camera
contains '"eye":\[0.5,0.5,[1-9][0-9.]*\],"target":\[0.5,0.5,0.0050*\],"up":\[0.0,1.0,0.0\]'
file=flat_y.vtu camera
contains '"eye":\[0.5,-[1-9][0-9.]*,0.5\],"target":\[0.5,0.0050*,0.5\],"up":\[0.0,0.0,1.0\]'
file=flat_x.vtu camera
contains '"eye":\[[1-9][0-9.]*,0.5,0.5\],"target":\[0.0050*,0.5,0.5\],"up":\[0.0,1.0,0.0\]'
size=21x21 file=long_z.vtu camera
contains '"eye":\[0.0500*,-[1-9][0-9.]*,2.0\]'
file=half.vtu camera
contains '"eye":\[0.5,0.10*,[1-9]' # not as flat
size=21x21 file=flat_y.vtu camera --up 0,1,0 # which is along the better view: the next best
contains '"eye":\[0.5,0.0050*,[1-9][0-9.]*\].*"up":\[0.0,1.0,0.0\]'
file=flat_x.vtu camera --up 0,0,1
contains '"eye":\[[1-9][0-9.]*,0.5,0.5\]'
file=flat_y.vtu camera --target 0,0,0
contains '"eye":\[0.0,-[1-9][0-9.]*,0.0\],"target":\[0.0,0.0,0.0\]'
finish
