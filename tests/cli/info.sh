# SPDX-License-Identifier: Apache-2.0
source=$(realpath "$(dirname "$0")/../..")
. "$(dirname "$0")/lib.sh"
needs vtk
scalar='0 1 nan 2 3 4 6 5' vtu cube.vtu "$five_tetrahedra" 10
accept info cube.vtu
contains 'points +8'
contains 'tetrahedron +5'
contains 'bounds +x \[0, 1\]'
contains 'point +s +float64 +\[0, 6\]  1 NaN'
contains ':2 +\[0, 1\]'
contains 'mag +\[0, 1.73205'
contains 'cell +c d +float64 +\[0.5, 4.5\]'
contains 'boundary faces +12'
contains 'components +1'
contains 'volume +1$'

accept info cube.vtu --json
contains '"points": 8,'
contains '"cells": 5,'
contains '"tetrahedron": 5'
contains '"tetrahedra": 5,'
contains '"name": "c d"'
contains '"nonfinite": 1'
contains '"component_ranges"'
contains '"boundary_faces": 12,'
contains '"volume": 1.0,'

vtu hexahedron.vtu '0 1 2 3 4 5 6 7' 12
accept info hexahedron.vtu
contains 'hexahedron +1'
contains 'volume +1$'

# The manual's list is that of a build with everything.
accept info --formats
contains 'VTK XML, unstructured grid +[.]vtu'
manual=$(sed -n 's/^| \(.*[^ ]\)  *| \(.*\) |$/\1  \2/p' "$source/src/cli/tetcast-files.7" | sed 's/   */  /')
while read -r row; do
  format=$(sed 's/   *.*//' <<<"$row") extensions=$(sed 's/.*   *//' <<<"$row")
  checks=$((checks + 1))
  grep -qxF "$format  $extensions" <<<"$manual" || fail "no row '| $format | $extensions |' in the manual"
done <<<"$output"
# The cube has s = x + 2 y + 3 z: half of it is below 3, and by symmetry as much is below 3 - d as above 3 + d.
vtu even.vtu "$five_tetrahedra" 10
accept info --statistics even.vtu
contains 'of the volume  1 %: 0.7114 .* 50 %: 3 '
"$tetcast" info --statistics --json even.vtu >even.json
python3 - even.json <<'END' || fail 'quantiles of the linear array'
import json, sys
with open(sys.argv[1]) as file:
    array = [a for a in json.load(file)['arrays'] if a['name'] == 's'][0]
pairs = array['quantiles']
assert [p[0] for p in pairs] == [0.01, 0.05, 0.25, 0.5, 0.75, 0.95, 0.99]
assert all(abs(pairs[i][1] + pairs[-1 - i][1] - 6) < 1e-12 for i in range(7))
assert abs((pairs[0][1]) ** 3 / 36 - 0.01) < 1e-12  # near the corner the volume is v^3 / (6 * 1 * 2 * 3)
END
refuse 2 'takes no input' info --formats cube.vtu

# Steps, blocks, and points to be merged.
vtu late.vtu "$five_tetrahedra" 10 "${cube//1/2}"
cat >two.pvd <<'END'
<VTKFile type="Collection" version="0.1"><Collection>
<DataSet timestep="0.5" file="cube.vtu"/><DataSet timestep="2" file="late.vtu"/>
</Collection></VTKFile>
END
accept info two.pvd
contains 'volume +1$'
accept info two.pvd --time=-1
contains 'volume +8$'
accept info two.pvd --time t=2 --json
contains '"volume": 8.0,'
contains '"step": 1,'
refuse 1 'has no time step 2; there are steps 0 to 1' info two.pvd --time 2
refuse 1 'has no time 1; the nearest is 0.5, of step 0' info two.pvd --time t=1
refuse 2 'time' info two.pvd --time soon
refuse 2 'expected a step' info two.pvd --time all
cat >two.vtm <<'END'
<VTKFile type="vtkMultiBlockDataSet" version="1.0"><vtkMultiBlockDataSet>
<Block name="body"><DataSet name="small" file="cube.vtu"/><DataSet name="large" file="late.vtu"/></Block>
</vtkMultiBlockDataSet></VTKFile>
END
accept info two.vtm --block large
contains 'volume +8$'
contains 'body/small'
refuse 1 'there are: body/small, body/large' info two.vtm --block medium
accept info two.vtm --block body/small --json
contains '"volume": 1.0,'
accept info cube.vtu --merge-tolerance 0
contains 'boundary faces +12'
refuse 2 'merge-tolerance' info cube.vtu --merge-tolerance=-1

# Curved cells in finer pieces: 1, 8 and 27 tetrahedra of one of second order, whose volume comes closer to the true one.
gmsh_curved curved.msh
accept info curved.msh
contains 'quadratic tetrahedron +1'
contains 'curved cells +1, edges in 2$'
contains 'tetrahedra +8$'
accept info curved.msh --subdivide 0
contains 'tetrahedra +8$'
accept info curved.msh --subdivide 1
contains 'edges in 1$'
contains 'tetrahedra +1$'
contains 'volume +0.166666667$'
accept info curved.msh --subdivide 3 --json
contains '"tetrahedra": 27,'
accept info hexahedron.vtu --subdivide 3
contains 'volume +1$'
for wrong in 17 -1 2.5 many ''; do refuse 2 'subdivide' info curved.msh --subdivide "$wrong"; done

if [ -c /dev/full ]; then
  "$tetcast" info cube.vtu >/dev/full 2>err && fail 'exit code 0 with a full standard output'
  grep -q '^tetcast: error: .*standard output' err || fail "$(cat err)"
fi
finish
