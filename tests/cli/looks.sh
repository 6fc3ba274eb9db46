# SPDX-License-Identifier: Apache-2.0
# looks.sh COMMAND LOOKS [TABLE]: first pictures, of which nothing is said but the file and at most the array. Each is to
# show what is in the mesh: neither a wall nor a fog, with most of the colour map, and the least and largest values. The
# numbers go to TABLE as well.
here=$(dirname "$(realpath "$0")")
looks=$(realpath "$2") table=${3:+$(realpath -m "$3")} # before the folder changes
. "$here/lib.sh"
needs vtk openimageio
data=${TETCAST_DATA-}
: >rows

# first FILE [OPTIONS…]: looks at the first picture of a file.
first() {
  local file=$1
  shift
  checks=$((checks + 1))
  "$tetcast" render "$file" "$@" -o picture.png --size 160x120 --save-scene scene.json --quiet ||
    { fail "render $file $*"; return; }
  "$looks" measure "$file" scene.json >>rows || fail "$(tail -n 1 rows)"
}

"$looks" make . || fail 'looks make'
for file in *.vtk; do first "$file"; done
# Eleven decades are told apart by their logarithm, both signs from their middle, others alike.
for pair in decades:logarithmic density:logarithmic signs:diverging front:linear sparse:linear; do
  checks=$((checks + 1))
  "$tetcast" render "${pair%:*}.vtk" -o picture.png --size 16x12 --stats stats.json --quiet
  grep -q "\"scale\": \"${pair#*:}\"" stats.json || fail "$pair: $(grep scale stats.json)"
done
for mesh in heat hydrogen shell trefoil; do first "$here/../../meshes/$mesh.vtu"; done
if [ -d "$data/volumes" ]; then
  for array in Density Pressure VelocityMagnitude; do first "$data/volumes/bluntfin_tet.vtu" --array $array; done
  for array in Density VelocityMagnitude; do first "$data/volumes/combustor_tet.vtu" --array $array; done
  for array in StagnationEnergy VelocityMagnitude; do first "$data/volumes/post_tet.vtu" --array $array; done
  for array in Temp Pres CH4 V:mag; do first "$data/volumes/disk_out_ref.vtu" --array $array; done
  for array in t u w; do first "$data/volumes/fire_ug.vtu" --array $array; done
  first "$data/volumes/can.vtu" --array VEL:mag
else
  echo 'without the datasets of others'
fi
cat rows
[ -z "$table" ] || {
  echo '| file, array | covered | mean α | α > 0.99 | colours seen | lowest 2 % | highest 2 % |'
  echo '| --- | --- | --- | --- | --- | --- | --- |'
  cat rows
} >"$table"
finish
