# SPDX-License-Identifier: Apache-2.0
# A picture of each time step: names, one range, one camera, what is kept of a run that was stopped.
. "$(dirname "$0")/lib.sh"
needs vtk openimageio

# Three steps: the same mesh twice, then one of twice the size; values up to 6, 60 and 0.6.
vtu a.vtu "$five_tetrahedra" 10
scalar='0 10 30 20 30 40 60 50' vtu b.vtu "$five_tetrahedra" 10
scalar='0 .1 .3 .2 .3 .4 .6 .5' vtu c.vtu "$five_tetrahedra" 10 "${cube//1/2}"
cat >s.pvd <<'END'
<VTKFile type="Collection" version="0.1"><Collection>
<DataSet timestep="0" file="a.vtu"/><DataSet timestep="0.5" file="b.vtu"/><DataSet timestep="2" file="c.vtu"/>
</Collection></VTKFile>
END
small='--size 40x30'

# Names.
accept render s.pvd --time all $small
exists s.0000.png s.0001.png s.0002.png
accept render s.pvd --time all $small -o x.png
accept render s.pvd $small -o y.##.png
accept render s.pvd $small -o z%03dz.png
accept render s.pvd --time=-2 $small -o one.%d.png
exists x.0000.png y.00.png z002z.png one.1.png
[ ! -e s.0003.png ] && [ ! -e one.0.png ] && [ ! -e y.03.png ] || fail "too many pictures: $(files)"
for i in 0 1 2; do
  same s.000$i.png x.000$i.png
  same s.000$i.png y.0$i.png
  same s.000$i.png z00${i}z.png
done
same s.0001.png one.1.png 'a step as it is in the series'
accept render s.pvd --time 1 --range series $small -o one.png
same s.0001.png one.png 'a step with the range of the series'
# Of a file without steps, too.
accept render b.vtu --time all $small
accept render b.vtu $small -o lone.##.png
accept render b.vtu $small -o lone.png
exists b.0000.png
same lone.png lone.00.png
accept render s.pvd $small -o 'plain#.png'
accept render a.vtu $small -o a.png
same a.png 'plain#.png' 'a plain name is for one picture of the first step'

# Ranges: the series' by default; each step's; a given one.
accept render s.pvd --time all --range 0,60 $small -o fixed.png
accept render s.pvd --time all --range series $small -o series.png
accept render s.pvd --time all --range step $small -o step.png
for i in 0 1 2; do same s.000$i.png series.000$i.png; done
same step.0000.png a.png 'a range of its own'
accept render b.vtu $small -o b.png
same step.0001.png b.png 'a range of its own'
scalar='7 7 7 7 7 7 7 7' vtu even_1.vtu "$five_tetrahedra" 10
cp a.vtu even_0.vtu
accept render even_0.vtu even_1.vtu --array s --range step $small -o even.##.png
accept render even_1.vtu --array s $small -o even.png
same even.01.png even.png 'one value, after a step of many'
differ s.0000.png a.png 'range'
same s.0001.png b.png 'the largest step decides'
accept render s.pvd --time all --preset inferno --range 0,60 $small -o inferno.png
differ fixed.0001.png inferno.0001.png preset
echo '{"color": [[0,1,0,0],[60,0,0,1]], "extinction": [[0,0],[60,5]]}' >t.json
accept render s.pvd --time all --transfer t.json $small -o given.png
accept render b.vtu --transfer t.json $small -o b.png
same given.0001.png b.png 'a transfer function'
# The camera is the first step's, and the mesh of the third is prepared anew.
accept render c.vtu --transfer t.json $small -o c.png
differ given.0002.png c.png 'camera'
accept render c.vtu --transfer t.json $small -o c.png --eye 0.5,0.5,3.8460652149512322 --target 0.5,0.5,0.5
accept render s.pvd --time all --transfer t.json $small --eye 0.5,0.5,3.8460652149512322 --target 0.5,0.5,0.5 -o given.png
same given.0002.png c.png 'the third mesh'

# Coefficients of the data need no range: each step is what it is alone, from the first one's camera.
accept render s.pvd --time all --extinction s $small -o direct.png --save-scene direct.json
accept render b.vtu --extinction s $small -o b.png
same direct.0001.png b.png coefficients
differ direct.0000.png direct.0001.png coefficients
mv direct.0002.png third.png
accept render --scene direct.json --time 2 -o direct.####.png
same direct.0002.png third.png 'coefficients, a saved scene'

# Statistics: an entry a step. Scenes: all of it again.
accept render s.pvd --time all $small -o x.png --stats stats.json --save-scene scene.json
[ "$(grep -c '"render_seconds"' stats.json)" = 3 ] || fail "statistics: $(cat stats.json)"
output=$(tr -d '\n' <stats.json)
contains '"step": 1, +"time": 0.5, +"output": "x.0001.png", +"kept": false'
mkdir again
mv scene.json again
sed -i 's|"input": "|"input": "../|' again/scene.json
accept render --scene again/scene.json
for i in 0 1 2; do same again/x.000$i.png x.000$i.png scene; done
accept render s.pvd --time all --range step $small -o step.png --save-scene step.json
rm step.0*.png
accept render --scene step.json
same step.0000.png a.png 'a saved scene with ranges of their own'

# Resumed: what is there is kept, if it is what would be made.
rm x.0002.png
touch -d '2001-01-01' x.0000.png x.0001.png
accept render s.pvd --time all $small -o x.png --resume --stats stats.json
same x.0002.png s.0002.png
[ "$(grep -c '"kept": true' stats.json)" = 2 ] || fail "kept: $(cat stats.json)"
[ "$(find . -maxdepth 1 -name 'x.*' ! -newermt 2002-01-01 | wc -l)" = 2 ] || fail "pictures were replaced: $(ls -l x.*)"
rm x.0000.png
accept render s.pvd --time all $small -o x.png --resume
same x.0000.png s.0000.png
rm x.0001.png
refuse 1 '.png'"' is not the picture" render s.pvd --time all $small -o x.png --resume --preset inferno
refuse 1 '.png'"' is not the picture" render s.pvd --time all --size 41x30 -o x.png --resume
rm -f y.*
accept render s.pvd --time all --range 6,60 $small -o y.png # empty but for one
rm y.0002.png
refuse 1 "--resume: 'y.0001.png' is not the picture" render s.pvd --time all --range 6,60 $small -o y.png --resume --preset inferno
accept render s.pvd --time all $small -o x.png # and anew
exists x.0001.png

# Stopped.
for signal in INT:130 TERM:143; do
  checks=$((checks + 1))
  IFS=: read -r name expected <<<"$signal"
  rm -f slow*
  # a shell keeps SIGINT from what runs beside it, unless it is told not to
  env --default-signal=INT "$tetcast" render s.pvd --array s -o slow.##.png --size 600x600 --samples 64 --stats slow.json --save-scene slow-scene.json 2>"$work.err" &
  pid=$!
  for _ in $(seq 600); do
    [ ! -e slow.00.png ] || break
    sleep 0.05
  done
  kill -s "$name" "$pid"
  wait "$pid"
  code=$?
  [ "$code" = "$expected" ] || fail "exit code $code after $name"
  [ "$(cat "$work.err")" = 'tetcast: error: interrupted' ] || fail "standard error: $(cat "$work.err")"
  rm -f "$work.err"
  exists slow.00.png
  [ ! -e slow.02.png ] && [ ! -e slow.json ] && [ ! -e slow-scene.json ] && [ -z "$(find . -name '.tetcast*')" ] ||
    fail "files are left: $(files)"
done
accept render s.pvd --array s -o slow.##.png --size 600x600 --samples 64 --resume --quiet
exists slow.00.png slow.01.png slow.02.png

# A step that can't be read ends the run, and what was made stays.
cp s.pvd bad.pvd
sed -i 's/c.vtu/missing.vtu/' bad.pvd
refuse 1 'missing.vtu' render bad.pvd --time all $small -o bad.png
"$tetcast" render bad.pvd --time all --range 0,60 $small -o bad.png 2>err && fail 'exit code 0 with a missing step'
grep -q '^tetcast: error: step 2: .*missing.vtu' err || fail "$(cat err)"
exists bad.0000.png bad.0001.png
sed 's/Name="s"/Name="t"/' b.vtu >other.vtu
sed -i 's/missing.vtu/other.vtu/' bad.pvd
refuse 1 "step 2: bad.pvd: has no array 's'" render bad.pvd --time all $small -o none.png
# Values that are not finite: said once, and not for each step.
scalar='0 nan 3 2 3 4 6 5' vtu a.vtu "$five_tetrahedra" 10
scalar='0 nan 30 nan 30 40 60 50' vtu b.vtu "$five_tetrahedra" 10
warn 'NaN' render s.pvd --time all $small -o nan.png
"$tetcast" render s.pvd --time all --array s $small -o nan.png 2>err
[ "$(wc -l <err)" = 1 ] || fail "$(cat err)"

# A series of a format whose files are tried in a child process first, also after pictures have been made.
if [ -d "$TETCAST_DATA/cells/ensight" ] && "$tetcast" info --formats | grep -qF .case; then
  cp "$TETCAST_DATA"/cells/ensight/elements6.{geo,Nsca} .
  for i in 0 1 2; do cp elements6.Nsca "n0$i.Nsca"; done
  printf '%s\n' FORMAT 'type: ensight' GEOMETRY 'model: elements6.geo' VARIABLE 'scalar per node: 1 s n**.Nsca' TIME 'time set: 1' \
    'number of steps: 3' 'filename start number: 0' 'filename increment: 1' 'time values: 0.0 0.5 1.5' >ensight.case
  accept render ensight.case --time all $small
  exists ensight.0001.png
  same ensight.0000.png ensight.0002.png
  accept info ensight.case
  contains '3, from t=0 to t=1.5'
fi

# Numbered files on the command line, in the order of their numbers, whatever order they come in.
scalar='0 1 3 2 3 4 6 5' vtu a.vtu "$five_tetrahedra" 10
scalar='0 10 30 20 30 40 60 50' vtu b.vtu "$five_tetrahedra" 10
mkdir numbered
cp a.vtu numbered/run_2.vtu
cp b.vtu numbered/run_10.vtu
cp c.vtu numbered/run_9.vtu
cat >numbers.pvd <<END
<?xml version="1.0"?><VTKFile type="Collection" version="0.1"><Collection>
<DataSet timestep="0" file="numbered/run_2.vtu"/><DataSet timestep="1" file="numbered/run_9.vtu"/>
<DataSet timestep="2" file="numbered/run_10.vtu"/></Collection></VTKFile>
END
accept render numbers.pvd $small -o listed.##.png
mkdir elsewhere
accept render numbered/run_*.vtu $small -o given.##.png --stats given.json --save-scene elsewhere/given-scene.json
for i in 00 01 02; do same listed.$i.png given.$i.png "picture $i"; done
[ "$(grep -c '"time": null' given.json)" = 3 ] || fail "times: $(cat given.json)"
accept render --scene elsewhere/given-scene.json -o again.##.png
for i in 00 01 02; do same listed.$i.png again.$i.png "picture $i of the scene"; done
rm again.01.png
accept render --scene elsewhere/given-scene.json -o again.##.png --resume --stats given.json
[ "$(grep -c '"kept": true' given.json)" = 2 ] || fail "kept: $(cat given.json)"
cd numbered || exit 1
accept render run_10.vtu run_2.vtu run_9.vtu $small # each by its own name
cd ..
same numbered/run_2.png listed.00.png
same numbered/run_9.png listed.01.png
same numbered/run_10.png listed.02.png
accept render numbered/run_*.vtu $small --time -1 -o last.png --range series
same last.png listed.02.png '--time -1'
accept render numbered/run_*.vtu $small --time 1 -o one.png
accept render numbered/run_9.vtu $small -o alone.png
same one.png alone.png '--time 1'
refuse 1 'steps 0 to 2' render numbered/run_*.vtu $small --time 3 -o x.png
refuse 1 'steps 0 to 2' render numbered/run_*.vtu $small --time -4 -o x.png
refuse 1 'missing_1.vtu' render missing_1.vtu missing_2.vtu $small -o x.##.png
# Other ways to number them.
numbers() { # EXPECTED-ORDER NAMES…: the order is told by the entries of the scene
  local expected=$1 name
  shift
  for name; do mkdir -p "$(dirname "$name")" && cp a.vtu "$name"; done
  accept render "$@" --size 9x9 -o n.##.png --save-scene n.json
  [ "$(tr -d ' \n' <n.json | sed 's/.*"input":\[//; s/\].*//')" = "$expected" ] || fail "$expected: $(cat n.json)"
}
numbers '"t_0.vtu","t_0.25.vtu","t_0.3.vtu","t_1.vtu","t_10.5.vtu"' t_10.5.vtu t_0.3.vtu t_1.vtu t_0.vtu t_0.25.vtu
numbers '"f.0.25.vtu","f.0.3.vtu"' f.0.3.vtu f.0.25.vtu
numbers '"x2.9.vtu","x2.10.vtu"' x2.10.vtu x2.9.vtu
numbers '"00.vtu","08.vtu","0010.vtu"' 0010.vtu 08.vtu 00.vtu
numbers '"p20260101000000000001.vtu","p20260101000000000002.vtu"' p20260101000000000002.vtu p20260101000000000001.vtu
numbers '"r_1/flow.vtu","r_2/flow.vtu"' r_2/flow.vtu r_1/flow.vtu
for pair in 'a.vtu b.vtu' 'a_1.vtu b_2.vtu' 'a1b1.vtu a2b2.vtu' 'a_1.vtu a_x.vtu' 'a_1.vtu a_1.vtu' 'a_1.vtu a_.vtu'; do
  # shellcheck disable=SC2086  # two words
  refuse 2 'a file that lists them (.pvtu, .vtm or .pvd)' render $pair -o x.##.png
done
for list in '["numbered/run_2.vtu", "a.vtu"]' '[]' '[3]' '["a.vtu", ""]'; do
  echo "{\"input\": $list, \"output\": \"x.##.png\"}" >list.json
  refuse 1 'input: expected a path, or a list of paths that differ in one number' render --scene list.json
done

# What makes no sense.
refuse 2 'all' render s.pvd --time every
refuse 2 'or step, or series' render s.pvd --range steps
refuse 2 'exclude' render s.pvd --range series --transfer t.json
refuse 2 '--time all' converge s.pvd -o report --time all
refuse 2 '--range series' converge s.pvd -o report --range series
refuse 1 'extension' render s.pvd --time all -o folder
finish
