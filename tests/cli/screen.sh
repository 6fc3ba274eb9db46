# SPDX-License-Identifier: Apache-2.0
# tetcast render: which rays make the picture, and what it has besides.
. "$(dirname "$0")/lib.sh"
needs vtk openimageio
vtu cube.vtu "$five_tetrahedra" 10 # s = x + 2 y + 3 z
view='--array s --eye 3,2,5 --size 61x43 --bare'

# rays FILE: how many a run took.
rays() { tr -d ' \n' <"$1" | sed 's/.*"rays":\([0-9]*\).*/\1/'; }

# ── few rays ──

accept render cube.vtu -o plain.png $view --stats plain.json
accept render cube.vtu -o four.png $view --samples 4
accept render cube.vtu -o all.png $view --adaptive 0
same all.png plain.png 'a difference of 0'
accept render cube.vtu -o all.png $view --adaptive 0,8,4
same all.png four.png 'a difference of 0, with samples'
for way in '--threads 1' '--threads 3' '--repeat 2'; do
  accept render cube.vtu -o few.png $view --adaptive 0.1,8 --stats few.json --save-scene few-scene.json $way
  [ ! -e first.png ] || same few.png first.png "$way"
  cp few.png first.png
done
differ few.png plain.png 'rays were left out'
[ "$(rays plain.json)" = $((61 * 43)) ] || fail "rays: $(rays plain.json)"
[ "$(rays few.json)" -lt $((61 * 43 / 2)) ] || fail "rays of few: $(rays few.json)"
accept render --scene few-scene.json -o again.png
same again.png few.png 'scene of few'
accept render --scene few-scene.json -o other.png --samples 1 # takes the place of the scene's key
same other.png plain.png 'samples in place of few'
accept render cube.vtu -o few.png $view --adaptive 0.1
accept render --scene few-scene.json -o other.png --adaptive 0.1 # 4, not the scene's 8
same other.png few.png 'the number by default'
refuse 2 'exclude each other' render cube.vtu --adaptive 0.1 --samples 4
refuse 2 'not possible with --adaptive' render cube.vtu -o a.exr --adaptive 0.1 --channels depth
refuse 2 'needs --blend composite' render cube.vtu --adaptive 0.1 --blend maximum
for text in x -1 nan 0.1,3 0.1,0 0.1,128 0.1,4.5 0.1,4,0 0.1,4,1.5 0.1,4,70000 0.1,4,1,1; do
  refuse 2 'expected EPS' render cube.vtu --adaptive $text
done

# ── channels ──

accept render cube.vtu -o two.tif $view --isosurface 3:red --channels cells,normal,depth --save-scene two.json
accept render cube.vtu -o other.tif $view --isosurface 3:red --channels depth,normal,cells
differ two.tif other.tif 'the order of the channels'
accept render --scene two.json -o again.tif
same again.tif two.tif 'scene with channels'
accept render cube.vtu -o cells.exr $view --blend maximum --channels value,cells
accept render cube.vtu -o cells.exr --eye 3,2,5 --extinction s --channels cells,transmittance
accept render cube.vtu -o cells.exr $view --integrator gauss:2 --channels cells
accept render cube.vtu -o normal.exr $view --slice 1,0,0,0.5 --channels normal
accept render cube.vtu -o sums.exr $view --blend additive --channels value,cells --save-scene sums.json
accept render --scene sums.json -o again.exr # whose range is not that of the picture any more
same again.exr sums.exr 'channels of a picture in its own range'
refuse 2 'error and normal' render cube.vtu -o a.exr --array s --channels normal,error
refuse 2 'only the exact integrator' render cube.vtu -o a.exr --array s --integrator gauss:2 --channels cells,error
refuse 2 'only value and cells' render cube.vtu -o a.exr --array s --blend maximum --channels normal
refuse 2 'normal: not possible' render cube.vtu -o a.exr --emission s --channels normal

# ── lines ──

accept render cube.vtu -o box.png $view --outline --save-scene box.json
accept render cube.vtu -o other.png $view --outline 0.4,0.4,0.4
same box.png other.png 'the colour by default'
accept render --outline '#666' cube.vtu $view -o other.png
same box.png other.png 'a colour as the next word'
accept render --outline cube.vtu $view -o other.png # which is no colour
same box.png other.png 'no colour as the next word'
accept render --scene box.json -o again.png
same again.png box.png 'scene with an outline'
differ box.png plain.png outline
accept render cube.vtu -o dark.png $view --outline --background black
accept render cube.vtu -o other.png $view --outline=0.75,0.75,0.75 --background black
same dark.png other.png 'the colour on a dark background'
accept render cube.vtu -o other.png --extinction s --outline
accept render cube.vtu -o other.png --array s --blend maximum --outline
accept render cube.vtu -o other.png --array s --blend additive --range 0,9 --outline
accept render cube.vtu -o other.png --array s --blend additive --outline
accept render cube.vtu -o a.exr --array s --blend maximum --outline --channels value
refuse 2 'expected nothing, or a colour' render cube.vtu --outline=nocolour

accept render cube.vtu -o edges.png $view --surface white --edges red --save-scene edges.json
accept render cube.vtu -o without.png $view --surface white
differ edges.png without.png edges
accept render --scene edges.json -o again.png
same again.png edges.png 'scene with edges'
refuse 2 'needs --surface' render cube.vtu --edges
refuse 2 'expected nothing, or a colour' render cube.vtu --surface --edges=0.5

# ── deep pictures ──

accept render cube.vtu -o deep.exr $view --deep --save-scene deep.json
accept render --scene deep.json -o again.exr
same again.exr deep.exr 'scene of a deep picture'
accept render cube.vtu -o other.exr $view --deep 32 # the next word
same other.exr deep.exr 'the number by default'
accept render --deep=3 cube.vtu $view -o three.exr --threads 1
accept render --deep=3 cube.vtu $view -o other.exr --threads 3
same other.exr three.exr threads
differ deep.exr three.exr 'the number of parts'
accept render cube.vtu -o half.exr $view --deep 3 --pixel-type half
differ half.exr three.exr 'type of pixels'
accept render cube.vtu -o emission.exr --eye 3,2,5 --size 9x9 --emission s --extinction s --deep 3
cp cube.vtu step_1.vtu
cp cube.vtu step_2.vtu
accept render step_1.vtu step_2.vtu -o 'step.##.exr' $view --deep 3 --range 0,6
same step.00.exr step.01.exr 'steps of a series'
refuse 2 'only .exr' render cube.vtu -o a.png --array s --deep
refuse 2 'float or half' render cube.vtu -o a.exr --array s --deep --pixel-type double
refuse 2 'not possible with --deep' render cube.vtu -o a.exr --array s --deep --channels depth
refuse 2 'needs --blend composite' render cube.vtu -o a.exr --array s --deep --blend maximum
refuse 2 'there is only exact' render cube.vtu -o a.exr --array s --deep --integrator gauss:2
refuse 2 'one ray per pixel' render cube.vtu -o a.exr --array s --deep --samples 4
refuse 2 'one ray per pixel' render cube.vtu -o a.exr --array s --deep --adaptive 0.1
refuse 2 '--outline: not possible' render cube.vtu -o a.exr --array s --deep --outline
for text in x 0 1025 2.5; do
  refuse 2 'expected nothing, or a whole number' render cube.vtu -o a.exr --deep=$text
done
finish
