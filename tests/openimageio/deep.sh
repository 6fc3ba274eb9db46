#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# deep.sh TETCAST TEST_DEEP MESHES: the command's deep pictures, flattened by OpenImageIO, are its flat ones.
set -eu
tetcast=$1
compare=$2
meshes=$3
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"

# check PARTS OPTIONS…: the parts are float, so that little is rounded; in half each channel is off by half's rounding.
check() {
  parts=$1
  shift
  "$tetcast" render "$@" --quiet --size 80x60 -o flat.exr --pixel-type float
  "$tetcast" render "$@" --quiet --size 80x60 -o deep.exr "--deep=$parts"
  "$compare" flat.exr deep.exr "$parts" 2e-6
  "$tetcast" render "$@" --quiet --size 80x60 -o half.exr "--deep=$parts" --pixel-type half
  "$compare" flat.exr half.exr "$parts" 1e-3
}
check 32 "$meshes/hydrogen.vtu"
check 5 "$meshes/shell.vtu" --eye 0.2,0.1,0.3 --target 2,1,0
check 7 "$meshes/shell.vtu" --ortho 2.5 --surface white:0.3 --isosurface 0.5:red:0.5 --clip 1,0,0,0
"$tetcast" render "$meshes/shell.vtu" --quiet --size 80x60 -o depth.exr --surface --clip 0,0,-1,0 --channels depth --pixel-type float
check 6 "$meshes/shell.vtu" --stop-depth depth.exr
