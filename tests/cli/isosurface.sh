# SPDX-License-Identifier: Apache-2.0
# tetcast render --isosurface, --slice, --surface: colours, light, scenes, series, and what is refused.
. "$(dirname "$0")/lib.sh"
needs vtk openimageio
vtu cube.vtu "$five_tetrahedra" 10 # s = x + 2 y + 3 z
down='--eye 0.5,0.5,5 --ortho 1.2 --size 41x31'

# Opaque, unlit and alone, a pixel has the surface's colour or the background's; without a colour it is the preset's.
accept render cube.vtu -o red.png --array s --isosurface 3:red --shade none $down --save-scene red.json
for way in '--traversal faces' '--isa scalar' '--normals flat' '--tolerance 0.1'; do
  accept render cube.vtu -o other.png --array s --isosurface 3:#f00:1 --shade none $down $way
  same other.png red.png "$way"
done
accept render cube.vtu -o named.png --array s --isosurface 3:#440154 --shade none $down
accept render cube.vtu -o preset.png --array s --isosurface 3 --range 3,6 --shade none $down --save-scene preset.json
same named.png preset.png 'colour of the preset'
differ named.png red.png colour
accept render cube.vtu -o lit.png --array s --isosurface 3:red $down
differ lit.png red.png light
accept render cube.vtu -o side.png --array s --isosurface 3:red --light 1,0,0:blue --material 0.1,0.9,0,1 $down
differ side.png lit.png 'another light'

# In the volume of a transfer function, it is drawn as well.
echo '{"color": [[0,0,1,0]], "extinction": [[0,1]]}' >fog.json
accept render cube.vtu -o fog.png --array s --transfer fog.json $down
accept render cube.vtu -o both.png --array s --transfer fog.json --isosurface 3:red:0.5 --isosurface 2:0,0,1 $down --save-scene both.json
differ both.png fog.png 'surfaces in the volume'

# The depth at which alpha exceeds one half is a channel that picture programs know, and that rays stop at again.
accept render cube.vtu -o depth.exr --array s --isosurface 3:red $down --channels depth --pixel-type float
warn 'the picture shows nothing: no surface' render cube.vtu -o behind.png --array s --isosurface 2.9:red $down --stop-depth depth.exr
accept render cube.vtu -o stop.png --array s --isosurface 3.1:red $down --stop-depth depth.exr
accept render cube.vtu -o free.png --array s --isosurface 3.1:red $down
same stop.png free.png 'what lies before the depth'
refuse 2 'error and depth' render cube.vtu -o a.exr --array s --channels error,depth
refuse 2 'only value and cells are possible' render cube.vtu -o a.exr --array s --blend maximum --channels depth
refuse 2 'depth: not possible' render cube.vtu -o a.exr --emission s --channels depth

# A scene makes the same picture again; the command line takes the place of its list.
for name in red preset both; do
  accept render --scene $name.json -o again.png
  same again.png $name.png "scene of $name"
done
accept render --scene both.json -o other.png --isosurface 3:red --shade none
for value in 3 '[3]' '[3, "2"]' true; do
  printf '{"input": "cube.vtu", "array": "s", "isosurface": %s}' "$value" >numbers.json
  refuse 1 'numbers.json: isosurface: expected text, written as for the option, or a list' render --scene numbers.json -o bad.png
done
printf '{"input": "cube.vtu", "array": "s", "isosurface": "3:red", "slice": ["0,0,1,0.5", "1,0,0,0.5:0.3"]}' >texts.json
accept render --scene texts.json -o texts.png
rm numbers.json texts.json

# A legend shows what some colours stand for, so it isn't there where all have been chosen.
accept render cube.vtu -o own.png --array s --isosurface 3:red --surface white:0.3 --save-scene own.json
accept render cube.vtu -o magma.png --array s --isosurface 3:red --surface white:0.3 --preset magma
same own.png magma.png 'no colour stands for a value'
accept render --scene own.json -o again.png
same own.png again.png 'a scene without a legend'
for surfaces in '--isosurface 3:red --isosurface 4 --surface white:0.3' '--isosurface 3:red --surface 0.3' '--isosurface 3:red --slice 0,0,1,0.5'; do
  # shellcheck disable=SC2086  # a list of options
  accept render cube.vtu -o own.png --array s $surfaces
  # shellcheck disable=SC2086
  accept render cube.vtu -o title.png --array s $surfaces --legend=title
  differ own.png title.png "a legend: $surfaces"
done
rm own.json
differ other.png both.png 'the list of the command line'
sed 's/"isosurface": \[[^]]*\]/"isosurface": "3:red"/' red.json >text.json
accept render --scene text.json -o again.png
same again.png red.png 'a single one as text'

# A slice has the colours of the scalar, or of the cells; the boundary those or one. Its value may be the next word.
accept render cube.vtu -o slice.png --array s --slice 0,0,1,0.5 $down
accept render cube.vtu -o same.png --array s --slice 0,0,-3,-1.5:1 --slice 1,0,0,7 $down --save-scene slice.json
same slice.png same.png 'one plane'
accept render cube.vtu -o cells.png --array 'c d' --slice 0,0,1,0.5:0.5 $down
accept render cube.vtu -o surface.png --array s --surface blue:0.5 --shade none $down --save-scene surface.json
accept render cube.vtu -o other.png --array s --surface=0,0,1:0.5 --shade none $down
same surface.png other.png 'one colour in two ways'
accept render --array s --surface cube.vtu -o scalar.png $down
accept render --array s --surface 0.5 cube.vtu -o half.png $down
differ scalar.png surface.png colour
differ scalar.png half.png opacity
for name in slice surface; do
  accept render --scene $name.json -o again.png
  same again.png $name.png "scene of $name"
done

warn 'values lie between 0 and 6' render cube.vtu -o none.png --array s --isosurface 7 --isosurface 1 $down
warn 'the picture shows nothing: no surface' render cube.vtu -o none.png --array s --isosurface 1:red:0 $down

for text in x 3:nocolour 3:0.5:red 3:red:2 3: 3:red:blue nan; do
  refuse 2 'expected VALUE' render cube.vtu --array s --isosurface $text
done
refuse 2 'expected nx,ny,nz,d' render cube.vtu --slice 0,0,0,1
refuse 2 'expected nx,ny,nz,d' render cube.vtu --slice 1,0,0,1:red
refuse 2 'expected [COLOUR]' render cube.vtu --surface=2
refuse 1 'traversal shell only' render cube.vtu -o a.png --array s --surface --traversal faces
for text in 0,0,0 1,2 1,2,3:5 1,2,3:red:red; do
  refuse 2 'expected x,y,z' render cube.vtu --array s --isosurface 3 --light $text
done
refuse 2 'expected ambient' render cube.vtu --array s --isosurface 3 --material 1,1,1,0
refuse 2 'need --isosurface or --surface' render cube.vtu --array s --light 1,0,0
refuse 2 '--channels error: not possible' render cube.vtu -o a.exr --array s --isosurface 3 --channels error
refuse 2 'there is only exact' render cube.vtu --array s --isosurface 3 --integrator gauss:2
refuse 2 'need --blend composite' render cube.vtu --array s --isosurface 3 --blend maximum
refuse 2 'exclude each other' render cube.vtu --isosurface 3 --extinction s
refuse 2 'without surfaces' converge cube.vtu -o report --isosurface 3
refuse 1 'two isosurfaces' render cube.vtu -o a.png --array s --isosurface 3 --isosurface 3.0
refuse 1 '--cell-to-point' render cube.vtu -o a.png --array 'c d' --isosurface 3
finish
