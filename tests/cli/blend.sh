# SPDX-License-Identifier: Apache-2.0
# tetcast render --blend: pictures of the largest, smallest and average value along rays and of its integral.
. "$(dirname "$0")/lib.sh"
needs vtk openimageio
states() { # FILE TEXT
  checks=$((checks + 1))
  grep -qF -- "$2" "$1" || fail "no '$2' in $1: $(cat "$1")"
}
vtu cube.vtu "$five_tetrahedra" 10 # s = x + 2 y + 3 z
down='--eye 0.5,0.5,5 --ortho 1.2 --size 41x31'

# Down along z the values are x + 2 y + 3, x + 2 y, and with a length of 1 twice x + 2 y + 1.5.
accept render cube.vtu -o maximum.png --array s --blend maximum --range 3,6 $down --stats stats.json
for at in minimum:0,3 average:1.5,4.5 additive:1.5,4.5; do
  accept render cube.vtu -o ${at%:*}.png --array s --blend ${at%:*} --range ${at#*:} $down
  same maximum.png ${at%:*}.png "${at%:*}"
done
states stats.json '"blend": "maximum"'
states stats.json '"error": null'
accept render cube.vtu -o field.png --array s --blend maximum $down
accept render cube.vtu -o wide.png --array s --blend maximum --range 0,6 $down
same field.png wide.png 'range of the field'
differ field.png maximum.png range
accept render cube.vtu -o composite.png --array s $down
accept render cube.vtu -o named.png --array s --blend composite $down
same composite.png named.png composite
differ composite.png field.png composite
for way in '--traversal faces' '--isa scalar' '--threads 1' '--tolerance 0.1'; do
  accept render cube.vtu -o other.png --array s --blend average --range 1.5,4.5 $down $way
  same other.png average.png "$way"
done
accept render cube.vtu -o cells.png --array 'c d' --blend maximum $down
accept render cube.vtu -o cells2.png --array 'c d' --blend minimum $down
differ cells.png cells2.png cells

# A transfer function gives its colours; its extinction hides nothing, not even where there is none, and no wall is seen.
for k in 0 1e9; do
  echo "{\"color\": [[3,1,0,0],[6,0,0,1]], \"extinction\": [[0,$k]]}" >$k.json
  accept render cube.vtu -o $k.png --array s --blend maximum --transfer $k.json $down
done
same 0.png 1e9.png extinction
differ 0.png maximum.png colours
warn 'the picture shows nothing: the mesh' render cube.vtu -o away.png --array s --blend maximum --eye 5,5,5 --target 9,9,9 --size 20x20

# Integrals: the default range is that of the picture, whatever the unit of length.
accept render cube.vtu -o sum.png --array s --blend additive $down --save-scene sum.json
vtu large.vtu "$five_tetrahedra" 10 "${cube//1/16}"
accept render large.vtu -o sum16.png --array s --blend additive --eye 8,8,80 --ortho 19.2 --size 41x31
same sum.png sum16.png 'unit of length'
differ sum.png additive.png 'range of the picture'
accept render cube.vtu -o double.tif --array s --blend additive $down --pixel-type double --channels value
accept render cube.vtu -o fixed.png --array s --blend additive --range 0,6 $down
differ sum.png fixed.png 'range given'

# A scene keeps it, and a channel has the values.
states sum.json '"blend": "additive"'
accept render --scene sum.json -o again.png
same sum.png again.png scene
accept render --scene sum.json -o other.png --blend minimum
differ sum.png other.png 'the option wins'
for file in value.exr value.tif; do
  accept render cube.vtu -o $file --array s --blend average $down --channels value
  accept render cube.vtu -o plain.${file#*.} --array s --blend average $down
  [ "$(wc -c <$file)" -gt "$(wc -c <plain.${file#*.})" ] || fail "$file has no channel more"
done
head -c 2000 value.exr | grep -qaF value || fail "value.exr has no channel of that name"

# Series: one range for all steps, but integrals need to be told.
vtu t_0.vtu "$five_tetrahedra" 10
scalar='0 2 6 4 6 8 12 10' vtu t_1.vtu "$five_tetrahedra" 10
accept render t_0.vtu t_1.vtu -o m.##.png --array s --blend maximum $down
exists m.00.png m.01.png
differ m.00.png m.01.png 'one range'
accept render t_0.vtu t_1.vtu -o a.##.png --array s --blend additive --range step $down
same a.00.png sum.png 'first step'
same a.01.png sum.png "second step's own range"
accept render t_0.vtu t_1.vtu -o r.##.png --array s --blend additive --range 0,9 $down
exists r.00.png r.01.png
differ r.00.png r.01.png 'one range'
refuse 2 '--range LO,HI or --range step' render t_0.vtu t_1.vtu -o b.##.png --array s --blend additive $down

# What is not possible.
refuse 2 'expected composite, maximum, minimum, average or additive' render cube.vtu --blend mip
refuse 2 'there is only exact' render cube.vtu --blend maximum --integrator midpoint:2
refuse 2 'only value and cells are possible' render cube.vtu -o a.exr --blend maximum --channels error
refuse 2 'colours are even in the values' render cube.vtu --blend maximum --log
refuse 2 'colours are even in the values' render cube.vtu --blend additive --centre 0
refuse 2 'needs --blend' render cube.vtu -o a.exr --channels value
refuse 2 'only .exr and .tif' render cube.vtu -o a.png --blend maximum --channels value
refuse 2 'exclude each other' render cube.vtu --blend maximum --extinction s
refuse 2 '--channels value: not possible' render cube.vtu -o a.exr --extinction s --channels value
refuse 2 'always exact' converge cube.vtu -o report --blend maximum
refuse 2 'always exact' converge --scene sum.json -o report
finish
