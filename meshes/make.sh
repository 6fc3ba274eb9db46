#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Makes the datasets of this folder again, and with "pictures" as second argument their pictures.
# usage: make.sh PATH/TO/tetcast [pictures]
set -eu
tetcast=$(realpath "$1")
cd "$(dirname "$0")"
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
${CC:-cc} -std=c17 -O2 -o "$work/surfaces" surfaces.c -lm
"$work/surfaces" "$work"
"$tetcast" mesh "$work/ball.smesh" --max-volume 5.5 --field orbital:4,2,1 --single -o hydrogen.vtu
"$tetcast" mesh "$work/box.smesh" --max-volume 3e-4 --field heat --single -o heat.vtu
"$tetcast" mesh "$work/trefoil.smesh" --max-volume 1.2e-3 --field gyroid:1.8 --single -o trefoil.vtu
"$tetcast" mesh "$work/shell.smesh" --max-volume 1.3e-4 --field shell:6,4,1.4 --single -o shell.vtu
if [ "${2:-}" = pictures ]; then
  for name in hydrogen heat trefoil shell radiograph orbital gyroid mantle section projection cloud boundary; do
    "$tetcast" render --scene "$name.json" -o "$name.png"
  done
  # Those of the README, each with the command that is given there.
  "$tetcast" render heat.vtu --size 640x480 -o gallery-heat.png
  "$tetcast" render trefoil.vtu --size 640x480 --preset RdBu_r --up 0,1,0 -o gallery-trefoil.png
  "$tetcast" render hydrogen.vtu --size 640x480 --background '#10131a' -o gallery-hydrogen.png
  "$tetcast" render shell.vtu --size 640x480 --clip -1,0.6,0,0 --slice -1,0.6,0,0 --surface 0.12 -o gallery-shell.png
  "$tetcast" render heat.vtu --size 640x480 --isosurface 0.2:0.25 --isosurface 0.45:0.4 --isosurface 0.8 --view -y -o gallery-surfaces.png
  "$tetcast" transfer heat.vtu --size 154x116 --sheet gallery-sheet.png -o "$work/heat.json"
  "$tetcast" converge hydrogen.vtu --repeat 9 -o "$work/report"
  for name in time stiffness; do
    cp "$work/report/$name.png" "converge-$name.png"
  done
fi
