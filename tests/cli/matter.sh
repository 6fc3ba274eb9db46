# SPDX-License-Identifier: Apache-2.0
# Meshes without arrays are drawn as uniform matter, in the colours of their blocks or materials where they have some.
. "$(dirname "$0")/lib.sh"
needs vtk openimageio

# bare FILE CELLS [NAME TYPE VALUES]: without arrays but for one over the cells.
bare() {
  vtu "$1" "$2" 10
  sed -i '/Name="\(s\|v\|flat\|c d\)"/d' "$1"
  [ $# -lt 3 ] || sed -i "s|<CellData>|&<DataArray type=\"$4\" Name=\"$3\" format=\"ascii\">$5</DataArray>|" "$1"
}
# colors PICTURE: how many different colours its pixels have, those of the background apart, in a PPM picture.
colors() {
  tail -c $((3 * 64 * 48)) "$1" | od -An -v -tu1 -w3 | sort -u | grep -vc ' 255 255 255'
}
small='--size 64x48 --eye 3,2,4'
bare bare.vtu "$five_tetrahedra"

# Path length: the alpha of uniform matter, half on average.
warn 'bare.vtu: has no arrays: drawn as uniform matter' render bare.vtu -o a.png $small --save-scene s.json
cp a.png first.png
warn 'uniform matter' render --scene s.json # the same again
same first.png a.png 'a saved scene'
refuse 1 'uniform matter' render bare.vtu -o b.png $small --strict
accept render bare.vtu -o b.png $small --quiet
same a.png b.png
scalar='1 1 1 1 1 1 1 1' vtu ones.vtu "$five_tetrahedra" 10
accept render ones.vtu --array s -o c.png $small
same a.png c.png 'a scalar that is 1 everywhere'
warn 'uniform matter' render bare.vtu -o d.png $small --preset inferno
differ a.png d.png
echo '{"color": [[0,1,0,0],[2,0,0,1]], "extinction": [[0,0],[2,4]]}' >t.json
warn 'uniform matter' render bare.vtu -o d.png $small --transfer t.json
accept render ones.vtu --array s -o c.png $small --transfer t.json
same d.png c.png
refuse 1 'no arrays' render bare.vtu -o x.png $small --array s
refuse 1 'no arrays' render bare.vtu -o x.png $small --extinction s
accept info bare.vtu
contains 'arrays +none: drawn as uniform matter'
accept info bare.vtu --json
warn 'uniform matter' converge bare.vtu -o report --size 9x9 --repeat 1 --no-plots
grep -q 'bare.vtu, uniform matter' report/report.md || fail "$(grep dataset report/report.md)"
cp bare.vtu step_1.vtu
cp bare.vtu step_2.vtu
warn 'uniform matter' render step_1.vtu step_2.vtu -o s.##.png $small
same s.00.png a.png
same s.01.png a.png

# Materials: whatever they are called and numbered, each is seen, in a colour of its own.
for type in Int32 UInt8 Int64; do
  for name in material MaterialIds physical attribute RegionId block; do
    bare m.vtu "$five_tetrahedra" $name $type '7 7 3 120 7'
    warn "in the colours of '$name'" render m.vtu -o m.ppm $small --save-scene m.json
  done
done
[ "$(colors m.ppm)" -gt 20 ] || fail "$(colors m.ppm) colours"
accept render --scene m.json -o n.ppm
same m.ppm n.ppm 'a saved scene'
output=$(tr -d ' \n' <m.json)
contains '"array":"block"'
contains '"extinction":\[\[[0-9.]+,[0-9.e-]+\]\]'
contains '"color":(\[\[?[^]]*\],?){6}\]' # two knots each of three labels
bare m.vtu "$five_tetrahedra" material Int32 '5 5 5 5 5'
warn "in the colours of 'material'" render m.vtu -o one.ppm $small
[ "$(colors one.ppm)" -lt "$(colors m.ppm)" ] || fail 'one material has as many colours as three'
warn "in the colours of 'material'" render m.vtu -o x.png $small --preset inferno
bare m.vtu "$five_tetrahedra" pressure Int32 '7 7 3 120 7' # a quantity is a scalar like any other
accept render m.vtu -o x.png $small
bare m.vtu "$five_tetrahedra" material Float64 '7 7 3 120 7'
accept render m.vtu -o x.png $small
bare m.vtu "$five_tetrahedra" material Int32 '7 7 3 120 7'
accept render m.vtu -o x.png $small --array material
sed -i 's|<PointData>|&<DataArray type="Float64" Name="p" format="ascii">0 1 2 3 4 5 6 7</DataArray>|' m.vtu
"$tetcast" render m.vtu -o x.png $small 2>&1 | grep -q uniform && fail 'a field is there to be drawn'

# Blocks, which a file has no array for.
bare one.vtu '0 1 3 4;1 2 3 6'
bare two.vtu '1 4 5 6;3 4 6 7'
bare three.vtu '1 3 4 6'
blocks() {
  echo '<?xml version="1.0"?><VTKFile type="vtkMultiBlockDataSet" version="1.0" byte_order="LittleEndian"><vtkMultiBlockDataSet>'
  for name; do echo "<DataSet index=\"$((i++))\" name=\"$name\" file=\"$name.vtu\"/>"; done
  echo '</vtkMultiBlockDataSet></VTKFile>'
}
i=0 blocks one two three >blocks.vtm
warn "in the colours of 'block'" render blocks.vtm -o blocks.ppm $small --save-scene b.json
[ "$(colors blocks.ppm)" -gt "$(colors one.ppm)" ] || fail 'blocks have one colour'
accept render --scene b.json -o again.ppm
same blocks.ppm again.ppm
accept info blocks.vtm
contains 'cell +block +int32 +\[0, 2\]'
warn 'has no arrays: drawn as uniform matter' render blocks.vtm -o x.png $small --block two
i=0 blocks one >single.vtm
warn 'has no arrays: drawn as uniform matter' render single.vtm -o x.png $small
cp blocks.vtm blocks_1.vtm
cp blocks.vtm blocks_2.vtm
warn "in the colours of 'block'" render blocks_1.vtm blocks_2.vtm -o s.##.ppm $small
same s.00.ppm blocks.ppm
same s.01.ppm blocks.ppm
i=0 blocks one two three | sed 's/three.vtu/ones.vtu/' >mixed.vtm # a block has an array: that is drawn
"$tetcast" render mixed.vtm -o x.png $small 2>&1 | grep -q uniform && fail 'a field is there to be drawn'
finish
