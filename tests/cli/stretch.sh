# SPDX-License-Identifier: Apache-2.0
# --stretch gives the picture of a file whose coordinates are multiplied.
. "$(dirname "$0")/lib.sh"
needs vtk openimageio
points='0.1 0 0.3  1.2 0 0.1  1 1.1 0  0 1 0.2  0 0.1 1  1 0 1.3  1.1 1 1  0 1.2 1.1'
# times X Y Z: the points with their coordinates multiplied.
times() { echo "$points" | xargs -n 3 | awk -v x="$1" -v y="$2" -v z="$3" '{printf "%.17g %.17g %.17g ", $1*x, $2*y, $3*z}'; }
kind='--size 53x37 --pixel-type double'

# pair X,Y,Z OPTIONS…: the stretched mesh and the file of the multiplied one, as tetrahedra and as a hexahedron that is cut.
pair() {
  local factors=$1 file
  shift
  for file in five hexahedron; do
    accept render $file.vtu --stretch "$factors" $kind -o one.tif "$@"
    accept render "$file-$factors.vtu" $kind -o two.tif "$@"
    same one.tif two.tif "$file $factors $*"
  done
}
for factors in 1,1,2 0.5,3,0.1 1,1,1; do
  # shellcheck disable=SC2086  # three words
  set -- ${factors//,/ }
  vtu five-$factors.vtu "$five_tetrahedra" 10 "$(times "$@")"
  vtu hexahedron-$factors.vtu '0 1 2 3 4 5 6 7' 12 "$(times "$@")"
done
vtu five.vtu "$five_tetrahedra" 10 "$points"
vtu hexahedron.vtu '0 1 2 3 4 5 6 7' 12 "$points"
for factors in 1,1,2 0.5,3,0.1 1,1,1; do
  pair $factors
  pair $factors --array v:mag --eye 3,2,5 --clip-box 0,0.8,0,2,0,0.9
done
echo '{"color": [[0,1,0,0],[6,0,0,1]], "extinction": [[0,0],[6,2]]}' >t.json
pair 1,1,2 --transfer t.json --shade volume --light 1,2,3 --shadows
pair 1,1,2 --isosurface 2.5 --slice 0,0,1,1.1 --outline --range 5%,95%
accept render five.vtu $kind -o plain.tif
accept render five.vtu --stretch 1,1,1 $kind -o one.tif
same plain.tif one.tif 'no stretch'
accept render five.vtu --stretch 1,1,2 $kind -o one.tif
differ plain.tif one.tif
# In single precision, too.
for file in five five-1,1,2; do sed -i '/<Points>/s/Float64/Float32/' $file.vtu; done
pair 1,1,2 --array s

# Of scenes; of steps of a series; of a report.
accept render five.vtu --stretch 0.5,3,0.1 $kind -o one.tif --save-scene s.json
accept render --scene s.json -o two.tif
same one.tif two.tif scene
accept render --scene s.json -o two.tif --stretch 1,1,1
differ one.tif two.tif
cp five.vtu step_1.vtu
cp hexahedron.vtu step_2.vtu
accept render step_1.vtu step_2.vtu --stretch 0.5,3,0.1 $kind -o step.##.tif --range step
same one.tif step.00.tif 'the first of a series'
accept converge five.vtu -o report --stretch 1,1,2 --no-plots --size 9x7 --repeat 1

# What can't be.
form='expected three factors x,y,z above 0'
for factors in 1,1 1,1,0 1,-1,1 2 1,1,1,1 1,1,nan 1,1,inf x ''; do
  refuse 2 "$form" render five.vtu --stretch "$factors" -o bad.png
done
echo '{"input": "five.vtu", "stretch": [1, 2]}' >bad.json
refuse 1 "stretch: $form" render --scene bad.json -o bad.png
refuse 1 'five.vtu: point 1: coordinate x is 1.2, and times 1e+39 more than its type holds' render five.vtu --stretch 1e39,1,1 -o bad.png
refuse 1 'coordinate x is 1.1e+300: meshes may reach to 1e+300 at most' render hexahedron.vtu --stretch 1e300,1,1 -o bad.png
refuse 1 'hexahedron.vtu: point 1: coordinate x is 1.2, and times 1.7e+308 more than its type holds' \
  render hexahedron.vtu --stretch 1.7e308,1,1 -o bad.png
finish
