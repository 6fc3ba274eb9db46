# SPDX-License-Identifier: Apache-2.0
# --exposure: stops of the colours that integer pixels hold.
. "$(dirname "$0")/lib.sh"
needs vtk openimageio
vtu cube.vtu "$five_tetrahedra" 10
small='--size 43x37'
knots() { echo "{\"color\": [[0,$1,0,0],[2,0,$2,$1],[6,0,0,$2]], \"extinction\": [[0,0],[6,2]]}"; }
knots 0.5 0.25 >t.json
knots 1 0.5 >double.json
knots 0.125 0.0625 >quarter.json

# A factor of a power of two is that of the transfer function's colours, to the bit, whatever lies behind.
for background in white '#123' 0.3,0.5,0.7,0.4 transparent; do
  for type in uint8 uint16; do
    for pair in 1:double -2:quarter; do
      accept render cube.vtu --transfer t.json $small --background $background --pixel-type $type --exposure "${pair%:*}" -o one.png
      accept render cube.vtu --transfer "${pair#*:}.json" $small --background $background --pixel-type $type -o two.png
      same one.png two.png "$background $type $pair"
    done
  done
done
accept render cube.vtu --transfer t.json $small -o plain.png
accept render cube.vtu --transfer t.json $small -o one.png --exposure 0
same plain.png one.png 'no exposure'
accept render cube.vtu --transfer t.json $small -o one.png --exposure 0.5 --save-scene s.json
differ plain.png one.png
accept render --scene s.json -o two.png
same one.png two.png scene
accept render --scene s.json -o two.png --exposure 0
same plain.png two.png 'the command line wins'

# Radiance that integer pixels don't hold as it is; the warnings are about what is shown.
sed 's/"s" format="ascii">[^<]*/"s" format="ascii">0 10 30 20 30 40 60 50/' cube.vtu >bright.vtu
warn 'above 1 all is white' render bright.vtu --emission s $small -o r.png
accept render bright.vtu --emission s $small -o r.png --exposure -7
accept render cube.vtu --transfer t.json $small -o one.png --exposure 3 # not even that of colours that are asked for
warn 'shows nothing' render cube.vtu --transfer t.json $small -o one.png --exposure -20 --background black

# Floating-point pixels stay as they are.
for name in one.exr one.tif; do
  accept render cube.vtu --transfer t.json $small -o plain-$name
  warn '--exposure has no effect: floating-point pixels' render cube.vtu --transfer t.json $small -o $name --exposure 2
  same plain-$name $name
done
refuse 1 '--exposure has no effect' render cube.vtu -o bad.exr --exposure 2 --strict
for stops in 1,2 x '' 2000 nan; do
  refuse 2 'expected a number of stops from -1000 to 1000' render cube.vtu -o bad.png --exposure "$stops"
done
refuse 2 'exposure' converge cube.vtu -o report --exposure 1
finish
