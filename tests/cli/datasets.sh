# SPDX-License-Identifier: Apache-2.0
# Datasets of other programs become pictures without any option; the picture does not depend on the number of threads.
. "$(dirname "$0")/lib.sh"
needs vtk openimageio
if [ ! -d "$TETCAST_DATA/volumes" ]; then
  echo "skipped: no datasets in '$TETCAST_DATA'"
  exit 77
fi
for file in "$TETCAST_DATA"/volumes/*.vtu "$TETCAST_DATA"/volumes/*.ex2; do
  name=$(basename "$file")
  name=${name%.*}
  accepts=accept
  [ "$name" != can ] || accepts="warn tangled" # some of its cells overlap
  $accepts render "$file" --size 200x150
  exists "$name.png"
  [ "$(stat -c %s "$name.png")" -gt 2000 ] || fail "$name: the picture is nearly empty"
  $accepts render "$file" --size 200x150 --pixel-type double -o one.tif --threads 1
  $accepts render "$file" --size 200x150 --pixel-type double -o two.tif --threads 2
  same one.tif two.tif "$name"
  $accepts info "$file"
done
finish
