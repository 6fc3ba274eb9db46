# SPDX-License-Identifier: Apache-2.0
# tetcast render --shade volume, --shadows, --ambient-occlusion, and transfer functions with rows: scenes, and what is refused.
. "$(dirname "$0")/lib.sh"
needs vtk openimageio
vtu cube.vtu "$five_tetrahedra" 10 # s = x + 2 y + 3 z
view='--eye 2,3,5 --fovy 20 --size 41x31'
echo '{"color": [[0,0,1,0],[6,1,0,0]], "extinction": [[0,0.5],[6,2]]}' >fog.json
echo '{"color": [[0,0,1,0]], "extinction": [[0,0]]}' >air.json

# Light changes the picture, shadows and the ambient light that arrives change it again, on all kernels alike.
accept render cube.vtu -o plain.png --array s --transfer fog.json $view
accept render cube.vtu -o lit.png --array s --transfer fog.json --shade volume $view --save-scene lit.json
accept render cube.vtu -o light.png --array s --transfer fog.json --shade all --light 1,0.2,0.3 $view
accept render cube.vtu -o shadow.png --array s --transfer fog.json --shade all --light 1,0.2,0.3 --shadows $view --save-scene shadow.json
accept render cube.vtu -o open.png --array s --transfer fog.json --shade volume --ambient-occlusion 16 $view --save-scene open.json
accept render cube.vtu -o tinted.png --array s --transfer fog.json --shade volume --light 1,0.2,0.3:red $view
differ lit.png plain.png light
differ light.png lit.png 'a light of its own'
differ shadow.png light.png shadows
differ open.png lit.png 'ambient occlusion'
differ tinted.png light.png 'the colour of a light'
for way in '--isa scalar' '--isa avx2' '--threads 1'; do
  accept render cube.vtu -o other.png --array s --transfer fog.json --shade volume $view $way
  same other.png lit.png "$way"
done
accept render cube.vtu -o plain_light.png --array s --transfer fog.json --shade volume --material 1,0,0,30 $view
same plain_light.png plain.png 'ambient light alone'
for name in lit shadow open; do
  accept render --scene $name.json -o again.png
  same again.png $name.png "scene of $name"
done

# What has nothing to fall on, or nothing to fall from.
refuse 2 'need --isosurface or --surface, on which the light falls, or --shade volume' render cube.vtu --array s --light 1,0,0
refuse 2 'need --shade volume, or' render cube.vtu --array s --shadows
refuse 2 'need a --light' render cube.vtu --array s --shade volume --shadows
refuse 2 'need a volume' render cube.vtu --array s --isosurface 3 --light 1,0,0 --shadows
refuse 2 'need a volume' render cube.vtu --array s --isosurface 3 --shade all
refuse 2 'not possible with --extinction' render cube.vtu --emission s --shade volume
refuse 2 'needs --blend composite' render cube.vtu --array s --shade volume --blend maximum
refuse 2 'there is only exact' render cube.vtu --array s --shade volume --integrator gauss:2
refuse 2 'light is known at the vertices only' render cube.vtu -o a.exr --array s --shade volume --channels error
refuse 2 'directions from 1 to 4096' render cube.vtu --array s --shade volume --ambient-occlusion 5000
refuse 1 'so no gradient; --cell-to-point' render cube.vtu --array 'c d' --shade volume
refuse 2 'shade volume: render only' converge cube.vtu --array s --shade volume -o report
accept render cube.vtu -o cells.png --array 'c d' --cell-to-point --shade volume $view

# Shares of the volume as the range: of s = x + 2 y + 3 z, whose values near the corner of 0 have a volume of v^3 / 36.
accept render cube.vtu -o shares.png --array s --range 1%,99% $view --save-scene shares.json
accept render cube.vtu -o range.png --array s --range 0.7113786608980126,5.288621339101988 $view
same shares.png range.png 'a range of shares'
accept render --scene shares.json -o again.png
same again.png shares.png 'scene of shares'
for text in 1%,99 99%,1% 1%,101% -1%,50% 50% %,%; do
  refuse 2 'shares of the volume' render cube.vtu --array s --range=$text
done
refuse 2 'in no range of values' render cube.vtu --array s --range 1%,99% --blend additive

# Rows: one alone is a transfer function of one dimension; |grad s| = sqrt(14) = 3.7 lies between rows; a cell array.
row() { printf '{"at": %s, "color": [[0,0,1,0],[6,1,0,0]], "extinction": [[0,%s],[6,%s]]}' "$1" "$2" "$3"; }
echo "{\"second\": \"gradient\", \"rows\": [$(row 2 0.5 2)]}" >one.json
echo "{\"second\": \"gradient\", \"rows\": [$(row 0 0 0), $(row 3 0.5 2), $(row 9 0.5 2)]}" >three.json
echo "{\"second\": \"c d\", \"rows\": [$(row 0 0 0), $(row 1 0.5 2)]}" >cell.json
for rows in one three; do
  accept render cube.vtu -o rows.png --array s --transfer $rows.json $view --save-scene rows_$rows.json
  same rows.png plain.png "$rows"
  accept render --scene rows_$rows.json -o again.png
  same again.png plain.png "scene of $rows"
done
accept render cube.vtu -o cell.png --array s --transfer cell.json $view
differ cell.png plain.png 'a cell array'
accept render cube.vtu -o rows_lit.png --array s --transfer three.json --shade volume $view
same rows_lit.png lit.png 'rows in the light'
refuse 1 "no array" render cube.vtu --array s --transfer <(sed 's/c d/nothing/' cell.json)
sed 's/c d/s/' cell.json >point.json
refuse 1 "expected one of cells" render cube.vtu --array s --transfer point.json
echo "{\"second\": \"gradient\", \"rows\": [$(row 2 0 0), $(row 2 0 0)]}" >same.json
refuse 1 'rows[1]: at 2 is not above' render cube.vtu --array s --transfer same.json
echo '{"second": "gradient", "rows": []}' >none.json
refuse 1 'from 1 to 64 rows' render cube.vtu --array s --transfer none.json
echo '{"second": "gradient", "rows": [{"color": [[0,0,1,0]], "extinction": [[0,1]]}]}' >nowhere.json
refuse 1 'rows[0]: expected {"at": value' render cube.vtu --array s --transfer nowhere.json
echo '{"at": 1, "color": [[0,0,1,0]], "extinction": [[0,1]]}' >lonely.json
refuse 1 'from 1 to 64 rows' render cube.vtu --array s --transfer lonely.json
refuse 1 'needs an array of points' render cube.vtu --array 'c d' --transfer one.json
refuse 2 'a transfer function, not a mesh' render three.json
refuse 1 'one with rows is for render only' converge cube.vtu --array s --transfer three.json -o report
finish
