# SPDX-License-Identifier: Apache-2.0
# A report on convergence: whole, with errors and orders as theory has them, and there or not there.
. "$(dirname "$0")/lib.sh"
needs vtk
plots=''
if ! gnuplot --version >/dev/null 2>&1; then
  echo 'no gnuplot: plots are not checked'
  plots=--no-plots
fi
vtu cube.vtu "$five_tetrahedra" 10
echo '{"color": [[-1,1,0.3,0.1],[7,0.2,0.5,1]], "extinction": [[-1,0.5],[7,9]]}' >smooth.json
echo '{"color": [[0,1,0,0],[2,0,0.3,1],[2,1,1,1],[6,0,0,1]], "extinction": [[0,3],[2,0],[2,5],[6,1]]}' >knots.json

header=study,integrator,parameter,precision,isa,tolerance,extinction_scale,mesh_size,cells,segments,repeats,seconds,max_error,rms_error,bound,peak

# holds REPORT CONDITION: every line of report.csv that CONDITION's first part, before =>, selects fulfils the second;
# there are such lines.
holds() {
  checks=$((checks + 1))
  local message
  message=$(awk -F, -v OFS=, "NR > 1 {
      study = \$1; integrator = \$2; n = \$3; isa = \$5; tolerance = \$6; scale = \$7; h = \$8; repeats = \$11
      seconds = \$12; max = \$13; rms = \$14; bound = \$15; peak = \$16
      if (${2%%=>*}) { count++; if (!(${2#*=>})) { print; bad = 1 } }
    } END { if (!count) print \"no line\" }" "$1/report.csv")
  [ -z "$message" ] || fail "$2 in $1: $message"
}

# slope REPORT SELECTION COLUMN LOW HIGH: the least-squares slope of log max_error over log COLUMN lies within bounds.
slope() {
  checks=$((checks + 1))
  local slope
  slope=$(awk -F, "NR > 1 {
      study = \$1; integrator = \$2; n = \$3; h = \$8; max = \$13
      if ($2) { x = log($3); y = log(max); c++; sx += x; sy += y; xx += x * x; xy += x * y }
    } END { print (c * xy - sx * sy) / (c * xx - sx * sx) }" "$1/report.csv")
  awk "BEGIN { exit !($slope >= $4 && $slope <= $5) }" || fail "slope $slope of $2 in $1, not from $4 to $5"
}

# whole REPORT PLOTS…: its files are all there and no others.
whole() {
  local report=$1 expected name
  shift
  expected=$(for name in report.csv report.md; do echo $name; done
    for name; do
      echo "$name.dat"
      echo "$name.gp"
      [ -n "$plots" ] || printf '%s.png\n%s.svg\n' "$name" "$name"
    done)
  checks=$((checks + 1))
  [ "$(ls -A "$report")" = "$(echo "$expected" | LC_ALL=C sort)" ] || fail "files of $report: $(ls -A "$report")"
  [ "$(head -1 "$report/report.csv")" = $header ] || fail "header of $report: $(head -1 "$report/report.csv")"
  [ -z "$(awk -F, 'NF != 16' "$report/report.csv")" ] || fail "lines of $report: $(awk -F, 'NF != 16' "$report/report.csv")"
  for name; do
    [ -n "$plots" ] || [ "$(head -c 4 "$report/$name.png" | tail -c 3)" = PNG ] || fail "$report/$name.png is no PNG"
    [ -n "$plots" ] || tail -2 "$report/$name.svg" | grep -q '</svg>' || fail "$report/$name.svg is not whole"
  done
  if grep -niE '\b(nan|inf)\b' "$report/report.csv"; then fail "$report has numbers that are none"; fi
}

export LC_ALL=C
for scene in smooth knots; do
  accept converge cube.vtu --transfer $scene.json -o $scene --view -z --size 40x30 --repeat 2 $plots
  whole $scene samples stiffness time
  holds $scene 'integrator == "exact" && tolerance == 0 && study == "time" => max <= 1e-13 && bound > 0 && bound < 1e-10'
  holds $scene 'integrator == "exact" && tolerance == 0 => max <= 1e-12'
  holds $scene 'integrator == "exact" && tolerance == 0 && scale < 1e-3 => max <= 1e-12 * peak'
  holds $scene 'tolerance > 0 => max <= tolerance && max <= bound'
  holds $scene 'tolerance > 0 && study == "time" => bound <= tolerance'
  # How far rounding may move a ray, times the extinction, comes on top: rays of some units, extinctions of up to 9 scale.
  holds $scene 'tolerance > 0 => bound <= tolerance + 1e-11 * scale'
  holds $scene 'integrator == "adaptive" => study == "time" && isa == "scalar" && bound == "" && n > 0 && max < 1'
  holds $scene 'integrator != "exact" => bound == ""'
  holds $scene 'study == "time" => seconds > 0 && rms <= max && scale == 1'
done
holds knots 'study == "time" && tolerance == 0.01 => bound > 1e-9'
holds smooth 'n == 1 => max > 1e-4' # there is something to converge
for integrator in midpoint trapezoid; do
  slope smooth "study == \"time\" && integrator == \"$integrator\" && n >= 4" n -2.1 -1.9
done
slope smooth 'study == "time" && integrator == "table" && n >= 16' n -2.4 -1.6
holds smooth 'study == "time" && integrator == "gauss" && n >= 12 => max < 1e-10'
slope knots 'study == "time" && integrator == "midpoint" && n >= 4' n -1.5 -0.5
holds smooth 'study == "stiffness" && scale < 2e-6 => peak > 0 && peak < 1e-4'
holds smooth 'study == "stiffness" && scale == 1 && integrator == "midpoint" => n == 8 && max > 1e-6'
for text in 'bit mantissas' 'cube.vtu, array s' '5 tetrahedra' '40 × 30' 'threads'; do
  grep -q "$text" smooth/report.md || fail "'$text' is not in the report"
done

# kernels REPORT ISA…: the time study has the exact integrator and the ladder of tolerances once by each of these, and
# the others by the first alone.
kernels() {
  local report=$1 expected got isa
  shift
  expected=$(for isa; do
    echo "exact $isa 10"
    [ "$isa" != "$1" ] || printf '%s\n' "adaptive $isa 5" "gauss $isa 8" "midpoint $isa 7" "table $isa 9" "trapezoid $isa 7"
  done | sort)
  got=$(awk -F, '$1 == "time" { count[$2 " " $5]++ } END { for (name in count) print name, count[name] }' \
    "$report/report.csv" | sort)
  checks=$((checks + 1))
  [ "$got" = "$expected" ] || fail "kernels of $report: $got; not: $expected"
}

# Integrators are compared in the scalar kernel; what packets add comes on top, where they are allowed and possible.
kernels smooth scalar "$(awk -F, '$1 == "stiffness" && $2 == "exact" { print $5; exit }' smooth/report.csv)"
holds smooth 'isa != "scalar" => integrator == "exact"'
holds smooth 'isa != "scalar" && study == "time" && tolerance == 0 => max > 0 && max <= 1e-13 && bound > 0'
grep -q '^Integrators are compared in the same kernel, \*scalar\*' smooth/report.md || fail 'the kernels are not explained'
grep -q '^| exact | scalar |.* 1.00 |' smooth/report.md || fail 'the exact integrator is not the measure'
cost=$(awk -F ' [|] ' '$1 == "| 1e-2" { print $2 }' smooth/report.md)
seconds=$(awk -F ' [|] ' '$1 == "| exact" && $2 == "scalar" { print $3 }' smooth/report.md)
[ -n "$cost" ] && [ "$cost" = "$seconds" ] || fail "exact costs '$cost', not what it took in the scalar kernel, '$seconds'"
grep -q "index 'exact-packets'" smooth/time.gp || fail 'packets are not in the plot'
! grep -q packets smooth/stiffness.gp smooth/samples.gp || fail 'packets are in the other plots'
if grep -qw avx2 /proc/cpuinfo; then
  accept converge cube.vtu --transfer smooth.json -o capped --size 12x9 --repeat 1 --isa avx2 $plots
  kernels capped scalar avx2
fi
for options in '--isa scalar' '--traversal faces'; do
  # shellcheck disable=SC2086  # a list of words
  accept converge cube.vtu --transfer smooth.json -o capped --size 12x9 --repeat 1 $options $plots
  kernels capped scalar
  holds capped 'isa != "" => isa == "scalar"'
  grep -q '^All integrators ran in the same kernel, \*scalar\*' capped/report.md || fail "not explained: $options"
  ! grep -q packets capped/time.gp || fail "packets are in the plot: $options"
done

# Refinement: piecewise linear fields are off by h², and integrators by their orders.
accept converge --refine -o refined $plots
whole refined refine
slope refined 'study == "refine" && integrator == "exact"' h 1.7 2.3
slope refined 'study == "integration" && integrator == "midpoint"' h 1.7 2.5
slope refined 'study == "integration" && integrator == "gauss"' h 3.6 4.6
holds refined 'study == "refine" && h < 0.02 => max < 1e-3'

# A scene's shape is taken, but neither its size nor what belongs to a picture; an existing report gives way.
cat >scene.json <<END
{"input": "cube.vtu", "output": "none/picture.exr", "array": "c d", "camera": {"eye": [3, 2, 5], "ortho": 2}, "size": [90, 30],
 "samples": 9, "repeat": 7, "tolerance": 0.1, "channels": "error", "stats": "none/stats.json", "transfer": "knots.json"}
END
accept converge --scene scene.json -o knots/ --no-plots --quiet
grep -q '384 × 128 pixels, one ray each' knots/report.md || fail "size: $(grep pixels knots/report.md)"
holds knots 'study == "time" => repeats == 3'
[ ! -e knots/time.png ] || fail 'plots of the former report are left'
holds knots 'study == "time" && integrator != "adaptive" && tolerance + 0 == 0 => max < 1e-12' # values are constant in a cell: any rule is exact
accept converge cube.vtu -o knots --size 9x9 --repeat 1 --traversal faces --threads 1 --no-plots

# Values that are not finite, a picture of nothing, a cell twice.
scalar='0 1 nan 2 3 4 6 5' vtu nan.vtu "$five_tetrahedra;0 1 3 4" 10
warn 'NaN' converge nan.vtu -o odd --size 12x9 --repeat 1 $plots
holds odd 'integrator == "exact" && tolerance == 0 => max <= 1e-12'
accept converge cube.vtu -o odd --size 12x9 --repeat 1 --array flat --eye 9,9,9 --target 10,10,10 $plots
grep -q 'picture is empty' odd/report.md || fail 'an empty picture is not called so'

# Cells that overlap: the renderer and the reference can't agree, and that is said.
vtu overlap.vtu '0 1 3 4;0 2 3 4;1 3 5 7;0 5 6 7' 10
warn 'brute-force reference differ' converge overlap.vtu -o overlap --transfer smooth.json --size 40x30 --repeat 1 --no-plots
grep -q '\*\*Warning' overlap/report.md || fail 'the report does not warn'

# Rays in faces: the picture is right, and is not accused. A hexahedron, which is cut along its diagonals, seen along these; a lattice seen
# along its lines by rays that all lie in its planes, first with values that neighbours share, then with values that they do not.
vtu hexahedron.vtu '0 1 2 3 4 5 6 7' 12
scalar='0 1 1 0 0 1 1 0' vtu hexahedron.vtu '0 1 2 3 4 5 6 7' 12
accept converge hexahedron.vtu -o faces --eye 0.5,0.5,3.8460652149512318 --size 32x24 --repeat 1 --no-plots --strict
holds faces 'integrator == "exact" && tolerance == 0 && study == "time" => max <= 1e-13'
grep -q 'of the rays run so' faces/report.md || fail 'rays in faces are not counted'
lattice() { # of 4³ voxels in [0, 4]³, as an image
  printf '%s\n' '# vtk DataFile Version 3.0' lattice ASCII 'DATASET STRUCTURED_POINTS' 'DIMENSIONS 5 5 5' 'ORIGIN 0 0 0' 'SPACING 1 1 1' \
    'POINT_DATA 125' 'SCALARS p double' 'LOOKUP_TABLE default'
  for ((i = 0; i < 125; i++)); do echo $((i % 5 + 2 * (i / 5 % 5) + i / 25)); done
  printf '%s\n' 'CELL_DATA 64' 'SCALARS c double' 'LOOKUP_TABLE default'
  for ((i = 0; i < 64; i++)); do echo $((i * 37 % 64)); done
}
lattice >lattice.vtk
accept converge lattice.vtk -o faces --view -z --array p --ortho 8 --size 8x8 --repeat 1 --no-plots --strict
holds faces 'integrator == "exact" && tolerance == 0 && study == "time" => max <= 1e-13'
[ "$(sed -n 's/^\* \([0-9]*\) of the rays run so.*/\1/p' faces/report.md)" -ge 20 ] || fail 'most rays run in faces'
warn 'could not be checked' converge lattice.vtk -o faces --view -z --array c --ortho 8 --size 4x4 --repeat 1 --no-plots
grep -q 'were replaced by others' faces/report.md || fail 'replaced rays are not counted'
accept converge lattice.vtk -o faces --view -z --array c --ortho 8 --size 12x12 --repeat 1 --no-plots --strict
holds faces 'integrator == "exact" && tolerance == 0 && study == "time" => max <= 1e-13'

# What is refused, before anything is read; nothing appears.
mkdir full empty
touch full/precious
refuse 2 'REPORTDIR' converge cube.vtu
refuse 2 'no input' converge -o r
refuse 2 'more than one input' converge a.vtu b.vtu -o r
for option in --stats --save-scene --pixel-type --background --integrator --tolerance --samples --channels; do
  refuse 2 "$option" converge cube.vtu -o r $option 1
done
for option in '--eye 1,2,3' '--size 9x9' '--array s' '--repeat 2' '--traversal faces'; do
  # shellcheck disable=SC2086  # two words
  refuse 2 'needs an input' converge --refine -o r $option
done
refuse 2 'whole number' converge cube.vtu -o r --repeat 0
refuse 1 "holds 'precious'" converge cube.vtu -o full
refuse 1 'cube.vtu' converge cube.vtu -o cube.vtu
refuse 1 'folder does not exist' converge cube.vtu -o no/such
refuse 1 'missing.vtu' converge missing.vtu -o r --no-plots
refuse 1 'missing.json' converge --scene missing.json -o r
accept converge cube.vtu -o empty --size 9x9 --repeat 1 --no-plots
exists empty/report.csv

# gnuplot that is missing, fails, or writes nothing; a full disk; a signal.
mkdir bin
without_gnuplot() {
  local before
  before=$(files)
  checks=$((checks + 1))
  PATH=$work/bin "$tetcast" converge cube.vtu -o r --array s --size 9x9 --repeat 1 2>"$work.err" && fail "exit code 0: $1"
  [ "$(wc -l <"$work.err")" = 1 ] && grep -q "^tetcast: error: .*$1" "$work.err" || fail "not '$1': $(cat "$work.err")"
  [ "$before" = "$(files)" ] || fail "files are left ($1): $(files)"
}
without_gnuplot 'no-plots'
shell=$(command -v sh)
fake_gnuplot() {
  printf '#!%s\ncase $* in *version*) echo gnuplot 5.4 ;; *) %s ;; esac\n' "$shell" "$1" >bin/gnuplot
  chmod +x bin/gnuplot
}
fake_gnuplot 'echo "line 3: no such colour" >&2; exit 1'
without_gnuplot 'time.gp: line 3: no such colour'
fake_gnuplot 'echo "line 3: no such colour" >&2; exit 0' # how it ends is not asked for
without_gnuplot 'time.gp: line 3: no such colour'
fake_gnuplot 'exit 0'
without_gnuplot 'in full'
printf '#!%s\necho command not found >&2; exit 127\n' "$shell" >bin/gnuplot
without_gnuplot 'no-plots'
rm -r bin
before=$(files)
(ulimit -f 1 && "$tetcast" converge cube.vtu -o r --size 9x9 --repeat 1 --no-plots) 2>&1 | cat >"$work.err"
grep -q '^tetcast: error: .*report.csv.*too large' "$work.err" || fail "a full disk: $(cat "$work.err")"
for arguments in 'cube.vtu --size 2000x2000' '--refine'; do
  # shellcheck disable=SC2086  # a list of words
  timeout --preserve-status -k 20 -s INT 1 "$tetcast" converge $arguments -o empty --no-plots 2>"$work.err"
  code=$?
  without_notes "$work.err"
  checks=$((checks + 1))
  [ $code = 130 ] || fail "exit code $code after a signal: $arguments"
  [ "$(cat "$work.err")" = 'tetcast: error: interrupted' ] || fail "standard error: $(cat "$work.err")"
done
rm -f "$work.err"
[ "$before" = "$(files)" ] || fail "files are left: $(files)"
files | grep -F .tetcast && fail 'temporary folders are left'
finish
