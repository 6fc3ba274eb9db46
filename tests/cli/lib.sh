# SPDX-License-Identifier: Apache-2.0
# Sourced by each script with the path of the command as $1: a folder of its own to work in, and checks that count
# failures.
tetcast=$(realpath "$1")
work=$(mktemp -d)
trap 'rm -rf "$work" "$work.out" "$work.err"' EXIT
cd "$work" || exit 1
ulimit -c 0
failures=0
checks=0

fail() {
  echo "FAILED: $*"
  failures=$((failures + 1))
}

# Ends the script.
finish() {
  echo "$checks checks, $failures failures"
  [ "$failures" = 0 ]
  exit
}

needs() {
  local adapter
  for adapter; do
    if ! "$tetcast" --version | grep -q "^adapters:.*$adapter"; then
      echo "skipped: built without $adapter"
      exit 77
    fi
  done
}

files() { find . | sort; }

# Notes of what was chosen where nothing was said are not looked at here.
without_notes() { sed -i '/^tetcast: note: /d' "$1"; }

# hear: what came on standard error, but for such notes, goes to $said. Without programs of others, which take longer to
# start than most of what is tested here takes.
hear() {
  local line
  said=
  while IFS= read -r line; do [[ $line = 'tetcast: note: '* ]] || said+=$line$'\n'; done <"$work.err"
  said+=$line # what ends without a newline
}

# refuse CODE TEXT ARGUMENTS…: the exit code is CODE, nothing comes on standard output, one line on standard error that
# contains TEXT, and no file appears, changes its size or goes.
refuse() {
  local code=$1 text=$2 before after got
  shift 2
  checks=$((checks + 1))
  before=$(find . -printf '%p %s\n')
  "$tetcast" "$@" >"$work.out" 2>"$work.err"
  got=$?
  after=$(find . -printf '%p %s\n')
  hear
  [ "$got" = "$code" ] || fail "exit code $got instead of $code: tetcast $*"
  [ ! -s "$work.out" ] || fail "standard output: $(head -c 200 "$work.out"): tetcast $*"
  [[ $said = *$'\n' && ${said%$'\n'} != *$'\n'* ]] || fail "not one line on standard error: $said: tetcast $*"
  [[ $said = 'tetcast: error: '* ]] || fail "no error line: tetcast $*"
  [[ $said = *"$text"* ]] || fail "'$text' is missing in '$said': tetcast $*"
  [ "$before" = "$after" ] || fail "files changed: $(diff <(echo "$before") <(echo "$after")): tetcast $*"
}

# accept ARGUMENTS…: exit code 0 and nothing on standard error; the output is kept in $output.
accept() {
  local got
  checks=$((checks + 1))
  output=$("$tetcast" "$@" 2>"$work.err")
  got=$?
  hear
  [ "$got" = 0 ] || fail "exit code $got: $said: tetcast $*"
  [ -z "$said" ] || fail "standard error: $said: tetcast $*"
}

# warn TEXT ARGUMENTS…: exit code 0 and a warning that contains TEXT.
warn() {
  local text=$1 line found=
  shift
  checks=$((checks + 1))
  "$tetcast" "$@" >/dev/null 2>"$work.err" || fail "exit code $?: $(cat "$work.err"): tetcast $*"
  while IFS= read -r line; do
    [[ $line != *'tetcast: warning: '*"$text"* ]] || found=1
  done <"$work.err"
  [ -n "$found" ] || fail "no warning '$text' in '$(cat "$work.err")': tetcast $*"
}

exists() {
  local name
  checks=$((checks + 1))
  for name; do [ -s "$name" ] || fail "$name is missing or empty"; done
}

same() {
  checks=$((checks + 1))
  cmp "$1" "$2" || fail "$1 and $2 differ${3:+: $3}"
}

differ() {
  checks=$((checks + 1))
  if cmp -s "$1" "$2"; then fail "$1 and $2 are the same${3:+: $3}"; fi
}

contains() {
  checks=$((checks + 1))
  printf '%s' "$output" | grep -qE -- "$1" || fail "no '$1' in: $output"
}

# vtu FILE CELLS TYPE [POINTS]: an ASCII file; CELLS are lists of point numbers separated by ';', TYPE what all of them
# are. The points are the unit cube's corners, in the order of VTK's hexahedron.
cube='0 0 0  1 0 0  1 1 0  0 1 0  0 0 1  1 0 1  1 1 1  0 1 1'
vtu() {
  local file=$1 cells=$2 type=$3 points=${4:-$cube} connectivity offsets='' types='' values='' count=0 end=0 cell
  local IFS=';'
  for cell in $cells; do
    local IFS=' '
    set -- $cell
    end=$((end + $#))
    offsets="$offsets $end"
    types="$types $type"
    values="$values $count.5"
    count=$((count + 1))
  done
  connectivity=${cells//;/ }
  cat >"$file" <<END
<?xml version="1.0"?>
<VTKFile type="UnstructuredGrid" version="0.1" byte_order="LittleEndian">
<UnstructuredGrid><Piece NumberOfPoints="8" NumberOfCells="$count">
<PointData>
<DataArray type="Float64" Name="s" format="ascii">${scalar:-0 1 3 2 3 4 6 5}</DataArray>
<DataArray type="Float32" Name="v" NumberOfComponents="3" format="ascii">$cube</DataArray>
<DataArray type="Float64" Name="flat" format="ascii">7 7 7 7 7 7 7 7</DataArray>
</PointData>
<CellData>
<DataArray type="Float64" Name="c d" format="ascii">$values</DataArray>
</CellData>
<Points><DataArray type="Float64" NumberOfComponents="3" format="ascii">$points</DataArray></Points>
<Cells>
<DataArray type="Int64" Name="connectivity" format="ascii">$connectivity</DataArray>
<DataArray type="Int64" Name="offsets" format="ascii">$offsets</DataArray>
<DataArray type="UInt8" Name="types" format="ascii">$types</DataArray>
</Cells>
</Piece></UnstructuredGrid></VTKFile>
END
}
# gmsh_curved FILE: a tetrahedron of second order, one of whose edges bulges.
gmsh_curved() {
  cat >"$1" <<'END'
$MeshFormat
2.2 0 8
$EndMeshFormat
$Nodes
10
1 0 0 0
2 1 0 0
3 0 1 0
4 0 0 1
5 .5 0 0
6 .7 .7 0
7 0 .5 0
8 0 0 .5
9 0 .5 .5
10 .5 0 .5
$EndNodes
$Elements
1
1 11 2 1 1 1 2 3 4 5 6 7 8 9 10
$EndElements
$NodeData
1
"s"
1
0
3
0
1
10
1 0
2 1
3 2
4 3
5 1
6 2
7 2
8 1
9 2
10 3
$EndNodeData
END
}
five_tetrahedra='0 1 3 4;1 2 3 6;1 4 5 6;3 4 6 7;1 3 4 6'
