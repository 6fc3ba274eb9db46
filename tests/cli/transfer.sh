# SPDX-License-Identifier: Apache-2.0
# tetcast transfer: what it proposes, writes, draws and refuses.
. "$(dirname "$0")/lib.sh"
needs vtk openimageio

# A lattice in whose middle values rise from 0 to 1: there is the boundary.
lattice() { # of 12³ hexahedra, as an image
  printf '%s\n' '# vtk DataFile Version 3.0' lattice ASCII 'DATASET STRUCTURED_POINTS' 'DIMENSIONS 13 13 13' 'ORIGIN 0 0 0' \
    'SPACING 1 1 1' 'POINT_DATA 2197' 'SCALARS front double' 'LOOKUP_TABLE default'
  awk 'BEGIN { for (i = 0; i < 2197; i++) { x = i % 13 + 0.02 * (int(i / 13) % 13); print 1 / (1 + exp(-0.6 * (x - 6))) } }'
  printf '%s\n' 'SCALARS flat double' 'LOOKUP_TABLE default'
  yes 5 | head -n 2197
  printf '%s\n' 'CELL_DATA 1728' 'SCALARS material int' 'LOOKUP_TABLE default'
  awk 'BEGIN { for (i = 0; i < 1728; i++) print int(i / 600) }'
  printf '%s\n' 'SCALARS heat double' 'LOOKUP_TABLE default'
  awk 'BEGIN { for (i = 0; i < 1728; i++) print i % 12 + 0.01 * i }'
}
lattice >l.vtk

# The first candidate is what render draws by itself.
accept transfer l.vtk --array front -o f.json
contains 'array +front'
contains '1  balanced .*; written'

accept render l.vtk --array front -o own.tif --size 80x60
accept render l.vtk --array front -o given.tif --size 80x60 --transfer f.json
same own.tif given.tif 'the first candidate'

# Another one, and one file for each; a sheet of all, plots over the data.
accept transfer l.vtk --array front -o 2.json --take 2 --sheet sheet.png --size 96x72
contains '2  boundaries .*; written'
differ f.json 2.json 'candidates'
exists sheet.png
accept transfer l.vtk --array front -o 2b.json --take 2 --sheet sheet.ppm --size 96x72 --threads 1 --quiet
[ -z "$output" ] || fail "not quiet: $output"
same 2.json 2b.json 'threads'
[ "$(head -c 15 sheet.ppm | tr '\n' ' ')" = "P6 444 240 255 " ] || fail "sheet: $(head -c 15 sheet.ppm)"
# Its bands lie at the boundary: the largest extinction is there.
checks=$((checks + 1))
tr -d ' \n' <2.json | sed 's/.*"extinction":\[\[//; s/\]\].*//; s/\],\[/\n/g' | LC_ALL=C awk -F, '
  $2 > most { most = $2; at = $1 } END { exit !(at > 0.3 && at < 0.7) }' || fail "bands: $(cat 2.json)"
for i in 3 4 5 6 7 8; do
  accept transfer l.vtk --array front -o $i.json --take $i --quiet
  accept render l.vtk --array front -o a.png --size 20x20 --transfer $i.json
done
if command -v gnuplot >/dev/null; then
  accept transfer l.vtk --array front -o f.json --plots plots --quiet
  exists plots/values.svg plots/values.png plots/gradients.svg plots/gradients.png plots/function.dat
  accept transfer l.vtk --array front -o f.json --plots plots --quiet # in their place
  touch plots/precious
  refuse 1 "holds 'precious'" transfer l.vtk --array front -o f2.json --plots plots
fi

# Cells have no isosurfaces; a constant has one colour; colours and ranges that are asked for.
accept transfer l.vtk --array heat -o c.json --sheet sheet.png
contains '1  balanced'
accept transfer l.vtk --array flat -o c.json
contains '1  balanced .*; written'
refuse 1 'there are 1 candidates' transfer l.vtk --array flat -o d.json --take 2
accept transfer l.vtk --array front -o c.json --preset magma --range 0.2,0.8
contains 'from 0.2 to 0.8'
accept transfer l.vtk --array front -o c.json --log
contains 'by the logarithm'

# What can't be.
refuse 2 'no file for the transfer function' transfer l.vtk
refuse 2 'no input' transfer -o x.json
refuse 1 'numbers of materials' transfer l.vtk --array material -o x.json
refuse 1 'at most 8 candidates' transfer l.vtk --array front -o x.json --take 9
refuse 2 'a candidate' transfer l.vtk -o x.json --take 0
refuse 2 'single step' transfer l.vtk -o x.json --time all
refuse 1 'does not exist' transfer l.vtk -o no/x.json
refuse 1 'are not supported' transfer l.vtk -o x.json --sheet x.xyz
refuse 2 'x.png: expected the name of a .json file' transfer l.vtk -o x.png # which would be lost
cp l.vtk l.json
refuse 2 'would replace the input' transfer l.json -o l.json
refuse 2 'unknown or ambiguous option --samples' transfer l.vtk -o x.json --samples 2
finish
