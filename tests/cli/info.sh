# SPDX-License-Identifier: Apache-2.0
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

if [ -c /dev/full ]; then
  "$tetcast" info cube.vtu >/dev/full 2>err && fail 'exit code 0 with a full standard output'
  grep -q '^tetcast: error: .*standard output' err || fail "$(cat err)"
fi
finish
