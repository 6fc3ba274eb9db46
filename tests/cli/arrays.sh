# SPDX-License-Identifier: Apache-2.0
# Which array is drawn, how one is named, and what becomes of those that can't be read.
. "$(dirname "$0")/lib.sh"
needs vtk openimageio
small='--size 20x15'

# notes TEXT ARGUMENTS…: exit code 0, and on standard error one line, this note.
notes() {
  local text=$1
  shift
  checks=$((checks + 1))
  "$tetcast" "$@" >/dev/null 2>"$work.err" || fail "exit code $?: $(cat "$work.err"): tetcast $*"
  [ "$(cat "$work.err")" = "tetcast: note: $text" ] || fail "'$(cat "$work.err")' instead of '$text': tetcast $*"
  rm -f "$work.err"
}
# silent ARGUMENTS…: exit code 0, and nothing on standard error.
silent() {
  checks=$((checks + 1))
  "$tetcast" "$@" >/dev/null 2>"$work.err" || fail "exit code $?: tetcast $*"
  [ ! -s "$work.err" ] || fail "standard error: $(cat "$work.err"): tetcast $*"
  rm -f "$work.err"
}

vtu cube.vtu "$five_tetrahedra" 10
notes 'draws point array s; --array chooses another: v, flat, c d' render cube.vtu $small -o a.png
notes 'draws point array s; --array chooses another: v, flat, c d' render cube.vtu $small -o a.png --strict
silent render cube.vtu $small -o b.png --array s
same a.png b.png
silent render cube.vtu $small -o a.png --quiet
silent info cube.vtu
scalar='4 4 4 4 4 4 4 4' vtu constant.vtu "$five_tetrahedra" 10 # and v varies
notes 'draws point array v; --array chooses another: s, flat, c d' render constant.vtu $small -o a.png
sed '/"v"/d; /"flat"/d' constant.vtu >cells.vtu
notes 'draws cell array c d; --array chooses another: s' render cells.vtu $small -o a.png
sed '/"c d"/d' cells.vtu >one.vtu
notes 'draws point array s, the only one' render one.vtu $small -o a.png
sed 's/<CellData>/<CellData Scalars="c d">/' cube.vtu >active.vtu
notes 'draws cell array c d; --array chooses another: s, v, flat' render active.vtu $small -o a.png
accept render cube.vtu $small -o b.png --array 'c d'
same a.png b.png
accept render cube.vtu $small -o a.png --save-scene scene.json # which has the array
silent render --scene scene.json -o b.png
same a.png b.png

# One name at the points and in the cells; components by name.
sed 's/"c d"/"s"/' cube.vtu >both.vtu
accept render both.vtu $small -o a.png --array s:cell --save-scene scene.json
accept render cube.vtu $small -o b.png --array 'c d'
same a.png b.png
silent render --scene scene.json -o b.png
same a.png b.png
accept render both.vtu $small -o a.png --array s:point
accept render both.vtu $small -o b.png --array s
same a.png b.png
accept render both.vtu $small -o a.png --array v:point:y
accept render both.vtu $small -o b.png --array v:1
same a.png b.png
accept render both.vtu $small -o b.png --array v:x
differ a.png b.png
accept render both.vtu $small -o a.png --extinction s:cell
accept render cube.vtu $small -o b.png --extinction 'c d'
same a.png b.png
refuse 1 "has no array 'v:cell'; there are: v (3 components), " render both.vtu -o none.png --array v:cell
refuse 1 "has no component 'w'; there are: 0 to 2 (x, y, z) and mag" render both.vtu -o none.png --array v:w
accept info both.vtu
contains '^  cell   s:cell '

# A damaged array, which costs what it was asked for.
sed 's/>7 7 7 7 7 7 7 7</>7 7 seven</' cube.vtu >bad.vtu
warn "array 'flat' is left out" render bad.vtu $small -o a.png
accept render cube.vtu $small -o b.png
same a.png b.png
silent render bad.vtu $small -o a.png --array s --strict
refuse 1 "'flat' can't be read" render bad.vtu -o none.png --array flat
refuse 1 "array 'flat' is left out" render bad.vtu -o none.png --strict
warn "array 'flat' is left out" info bad.vtu
sed '/"s"/d; /"v"/d; /"c d"/d' bad.vtu >none.vtu
refuse 1 "array 'flat' can't be read" render none.vtu -o none.png
sed '/"s"/{p; s/0 1 3/9 9 9/}' cube.vtu >twice.vtu
warn "'s' is left out: it is the second of that name" render twice.vtu $small -o a.png
accept render cube.vtu $small -o b.png
same a.png b.png

# Coordinates that nothing can be computed with are the mesh's fault, not that of the camera.
vtu far.vtu "$five_tetrahedra" 10 '0 0 0  1e301 0 0  1 1 0  0 1 0  0 0 1  1 0 1  1 1 1  0 1 1'
refuse 1 'far.vtu: point 1: coordinate x is 1e+301' render far.vtu -o none.png
refuse 1 'far.vtu: point 1: coordinate x is 1e+301' info far.vtu
sed 's/1e301/-1.7e308/; s/>0 0 0  /&/; s/ 0 1 1</ 1.7e308 1 1</' far.vtu >wide.vtu
refuse 1 'wide.vtu: point 1: coordinate x is -1.7e+308' render wide.vtu -o none.png

# OpenFOAM: what only its own programs can expand, in one of the fields and in one of the steps.
if "$tetcast" info --formats | grep -qF .foam; then
  foam() { printf 'FoamFile { version 2.0; format ascii; class %s; object %s; }\n%s\n' "$1" "$2" "$3"; }
  mkdir -p case/constant/polyMesh case/0 case/1 case/system
  : >case/a.foam
  foam dictionary controlDict 'startFrom startTime; startTime 0; writeFormat ascii;' >case/system/controlDict
  foam vectorField points '8((0 0 0)(1 0 0)(1 1 0)(0 1 0)(0 0 1)(1 0 1)(1 1 1)(0 1 1))' >case/constant/polyMesh/points
  foam faceList faces '6(4(0 3 2 1)4(4 5 6 7)4(0 1 5 4)4(2 3 7 6)4(0 4 7 3)4(1 2 6 5))' >case/constant/polyMesh/faces
  foam labelList owner '6(0 0 0 0 0 0)' >case/constant/polyMesh/owner
  foam labelList neighbour '0()' >case/constant/polyMesh/neighbour
  foam polyBoundaryMesh boundary '1(walls { type wall; nFaces 6; startFace 0; })' >case/constant/polyMesh/boundary
  for step in 0 1; do
    foam volScalarField p "dimensions [0 2 -2 0 0 0 0]; internalField uniform $step; boundaryField { walls { type zeroGradient; } }" >case/$step/p
    foam volScalarField q 'dimensions [0 2 -2 0 0 0 0]; internalField nonuniform #codeStream { code #{ x; #}; }; boundaryField { walls { type zeroGradient; } }' >case/$step/q
  done
  foam volScalarField q 'dimensions [0 0 0 0 0 0 0]; internalField uniform 5; boundaryField { walls { type zeroGradient; } }' >case/0/q
  silent render case/a.foam $small --time all --array p -o p.png
  exists p.0000.png p.0001.png
  accept render case/a.foam $small --time all -o q.png # draws p, as a note says
  exists q.0000.png q.0001.png
  warn "'q' is left out" render case/a.foam $small --time 1 -o b.png
  refuse 1 "'q' can't be read" render case/a.foam --time 1 --array q -o none.png
  accept render case/a.foam $small --array q -o a.png
  silent info case/a.foam
  # The programs that read such files: whatever the signals are that the command was started with; missing.
  for signal in CHLD PIPE; do
    env --ignore-signal=$signal "$tetcast" render case/a.foam $small --array q -o b.png || fail "exit code $? with $signal ignored"
    same a.png b.png $signal
  done
  mkdir nothing
  export TETCAST_LIBEXEC=$work/nothing
  refuse 1 'nothing/tetcast-vtk-openfoam, which can' info case/a.foam
  accept info cube.vtu
  unset TETCAST_LIBEXEC
fi

# Points where they were at first, which only Exodus knows of, is kept in a scene.
accept render cube.vtu $small -o a.png --no-displacement --save-scene scene.json
output=$(cat scene.json)
contains '"no_displacement": true'
accept render --scene scene.json -o b.png
same a.png b.png
finish
