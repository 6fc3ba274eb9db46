# SPDX-License-Identifier: Apache-2.0
# Pictures of which nothing is said: the box, the legend, the background, the colours, and what states them.
. "$(dirname "$0")/lib.sh"
needs vtk openimageio
vtu cube.vtu "$five_tetrahedra" 10 # s = x + 2 y + 3 z

states() { # FILE TEXT…
  local text
  checks=$((checks + 1))
  for text in "${@:2}"; do tr -d ' \n' <"$1" | grep -q -- "$text" || fail "no '$text' in $1: $(cat "$1")"; done
}
size='--array s --size 320x240'

# What is round the picture goes by itself, or all at once.
accept render cube.vtu -o first.ppm $size --save-scene first.json --stats first-stats.json
accept render cube.vtu -o bare.ppm $size --bare
differ first.ppm bare.ppm 'decorations'
accept render cube.vtu -o plain.ppm $size --bare --background white
same bare.ppm plain.ppm 'a bare picture lies on white'
accept render cube.vtu -o soft.ppm $size --bare --background soft
differ soft.ppm plain.ppm 'a soft background'
accept render cube.vtu -o lines.ppm $size --bare --background soft --outline
differ lines.ppm soft.ppm 'an outline'
refuse 2 'exclude each other' render cube.vtu -o no.ppm --bare --legend
accept render cube.vtu -o title.ppm $size --legend='Temperature [K]'
differ title.ppm first.ppm 'a title'
# Letters that aren't ASCII are drawn, or, where OpenImageIO can't, a warning says what stands for them.
checks=$((checks + 1))
"$tetcast" render cube.vtu -o letters.ppm $size --legend='T [°C]' 2>"$work.err" || fail 'letters are refused'
cp "$work.err" letters.txt
accept render cube.vtu -o marks.ppm $size --legend='T [?C]'
if grep -q "warning: image 'letters.ppm': letters of 'T \[°C\]' are drawn as question marks" letters.txt; then
  same letters.ppm marks.ppm 'a question mark for each letter'
else
  [ ! -s letters.txt ] || fail "$(cat letters.txt)"
  differ letters.ppm marks.ppm 'letters'
  accept render cube.vtu -o bits.ppm $size --legend='T [0C]' # the last bits of them alone
  differ letters.ppm bits.ppm 'letters'
fi

# pixel FILE X Y: the three numbers of a pixel of a PPM picture of 320 × 240.
pixel() { tail -c $((3 * 320 * 240)) "$1" | od -An -v -tu1 -j $((3 * ($3 * 320 + $2))) -N 3 | xargs; }
checks=$((checks + 3))
[ "$(pixel soft.ppm 0 0 | cut -d ' ' -f 1)" -lt "$(pixel soft.ppm 0 239 | cut -d ' ' -f 1)" ] || fail 'darker below'
[ "$(pixel bare.ppm 0 0)" = '255 255 255' ] || fail "a corner of a bare picture: $(pixel bare.ppm 0 0)"
# The bar has the colours of both ends of the map, one above the other.
bar=$(tail -c $((3 * 320 * 240)) first.ppm | od -An -v -tu1 -w3 | awk '($1 - 68) ^ 2 + ($2 - 1) ^ 2 + ($3 - 84) ^ 2 < 50 { low = NR }
  ($1 - 253) ^ 2 + ($2 - 231) ^ 2 + ($3 - 37) ^ 2 < 50 { if (!high) high = NR } END { print (high && low > high + 320 * 80) }')
[ "$bar" = 1 ] || fail 'no bar from the last colour down to the first'

# A scene says what is on, and nothing else is.
states first.json '"outline":""' '"legend":""' '"background":"soft"'
accept render --scene first.json -o again.ppm
same first.ppm again.ppm 'a scene with all of it'
accept render cube.vtu -o x.ppm $size --bare --save-scene bare.json
accept render --scene bare.json -o again.ppm
same bare.ppm again.ppm 'a scene without'
accept render --scene bare.json -o again.ppm --legend
differ bare.ppm again.ppm 'a scene without, and a legend'

# Floating-point pixels have none of it.
accept render cube.vtu -o first.tif $size
accept render cube.vtu -o bare.tif $size --bare
same first.tif bare.tif 'floating-point pixels'

# What was chosen, and why.
states first-stats.json '"array":"s"' '"preset":"viridis"' '"scale":"linear"' '"why":"nothingwassaid:oblique'
accept render cube.vtu -o a.png $size --stats s.json --range 0,3 --view +x
states s.json '"range":\[0.0,3.0\]' '"why":"theviewwasgivenbyitsname"'

# The range of colours. Logarithms, both sides of a middle, and what has neither.
scalar='1e-6 1e-5 1e-4 1e-3 1e-2 1e-1 1 10' vtu decades.vtu "$five_tetrahedra" 10
scalar='-3 -2 -1 0 1 2 3 2.5' vtu signed.vtu "$five_tetrahedra" 10
scalar='7 7 7 7 7 7 7 7' vtu constant.vtu "$five_tetrahedra" 10
scalar='-7 -6 -5 -4 -3 -2 -1 -0.5' vtu negative.vtu "$five_tetrahedra" 10
for file in decades signed constant negative; do
  accept render $file.vtu -o $file.png $size --stats $file.json
done
states signed.json '"scale":"diverging"' '"preset":"coolwarm"' '"range":\[-3.0,3.0\]'
accept render decades.vtu -o a.png $size --log --stats s.json
states s.json '"scale":"logarithmic"'
accept render decades.vtu -o a.png $size --log --range 1e-4,1 --stats s.json
states s.json '"scale":"logarithmic"' '"range":\[0.0001,1.0\]'
accept render signed.vtu -o a.png $size --centre 1 --stats s.json
states s.json '"scale":"diverging"' '"range":\[-[23].[0-9]*,[45].[0-9]*\]'
accept render signed.vtu -o a.png $size --preset magma --stats s.json
states s.json '"preset":"magma"' '"scale":"diverging"'
refuse 1 'only those above 0 have a logarithm' render negative.vtu -o no.png --array s --log
warn 'values down to -3' render signed.vtu -o a.png $size --log
refuse 2 '--range must be above 0' render cube.vtu -o no.png --array s --log --range 0,1
refuse 2 'exclude each other' render cube.vtu -o no.png --log --centre 1
refuse 2 'exclude each other' render cube.vtu -o no.png --log --transfer t.json
accept render constant.vtu -o a.png $size --log
# A logarithmic map never begins at 0: neither by shares of the volume, whose values the range hasn't, nor where twelve decades below the largest value
# there is no number.
scalar='0 0 0 0 0 0 0 1' vtu zeros.vtu "$five_tetrahedra" 10
scalar='0 0 0 0 0 0 0 1e-320' vtu tiny.vtu "$five_tetrahedra" 10
refuse 1 'the --range of 0% to 90% goes from 0 to ' render zeros.vtu -o no.png --array s --log --range 0%,90%
refuse 1 'the --range of 0% to 90% goes from 0 to ' transfer zeros.vtu -o no.json --array s --log --range 0%,90%
warn 'values down to -3' render signed.vtu -o a.png $size --log --range 90%,100% --stats s.json
states s.json '"scale":"logarithmic"'
accept render tiny.vtu -o a.png $size --log --stats s.json
states s.json '"scale":"linear"'

# A colour map by its name alone keeps what is found from the values; a range is taken at its word.
accept render cube.vtu -o a.ppm $size --bare --preset inferno
differ a.ppm bare.ppm 'colours'

# Numbers of materials have a colour each, whatever else is in the file, and what is said of them counts.
vtu labels.vtu "$five_tetrahedra" 10
sed -i 's|<CellData>|&<DataArray type="Int32" Name="material" format="ascii">7 7 3 120 7</DataArray>|' labels.vtu
accept render labels.vtu -o labels.ppm --array material --size 320x240 --stats s.json
states s.json 'numbersofmaterials'
accept render labels.vtu -o red.ppm --array material --size 320x240 --label '3:#ff0000' --label 7:0.05
differ labels.ppm red.ppm labels
accept render labels.vtu -o numbers.ppm --array material --size 320x240 --range 0,120
differ labels.ppm numbers.ppm 'numbers with a range'
warn 'no cell has the number 9' render labels.vtu -o a.ppm --array material --label 9:red
refuse 1 'are not numbers of materials' render cube.vtu -o no.png --array s --label 3:red
refuse 2 'expected NUMBER' render labels.vtu -o no.png --array material --label red
finish
