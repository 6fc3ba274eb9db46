# SPDX-License-Identifier: Apache-2.0
# No output replaces another file of the run, private files stay private, links are followed, and what killed runs leave is
# removed by the next one.
. "$(dirname "$0")/lib.sh"
needs vtk openimageio
vtu in.vtu "$five_tetrahedra" 10
echo '{"color": [[0,1,0,0],[6,0,0,1]], "extinction": [[0,0],[6,0.5]]}' >t.json
small='--size 16x12 --threads 1'

# One file for two things: refused, and nothing changes.
ln -s in.vtu link.vtu
ln in.vtu hard.vtu
mkdir sub
ln -s ../in.vtu sub/deep.vtu
ln -s nothing.png dangling.json
cp in.vtu in.png
cp in.vtu in.tif
for name in in.vtu ./in.vtu link.vtu hard.vtu sub/deep.vtu "$PWD/in.vtu" sub/../in.vtu; do
  for option in --stats --save-scene; do
    refuse 2 "would replace the input" render in.vtu -o a.png $small $option "$name"
    refuse 2 "would replace the input" render "$name" -o a.png $small $option in.vtu
  done
done
refuse 2 "would replace the input, 'in.png'" render in.png $small
refuse 2 'would replace the input' render in.tif -o ./in.tif $small
for name in same.png ./same.png "$PWD/same.png" sub/../same.png; do
  refuse 2 'are the same file' render in.vtu -o same.png --stats "$name" $small
  refuse 2 'are the same file' render in.vtu -o "$name" --save-scene same.png $small
  refuse 2 'are the same file' render in.vtu -o a.png --save-scene same.png --stats "$name" $small
done
refuse 2 'are the same file' render in.vtu -o nothing.png --stats dangling.json $small
refuse 2 'would replace --transfer' render in.vtu -o a.png --transfer t.json --stats t.json $small
echo '{"input": "in.vtu", "output": "a.png", "size": [9, 9]}' >scene.json
refuse 2 'would replace --scene' render --scene scene.json --save-scene ./scene.json
cp in.vtu step_1.vtu
cp in.vtu step_2.vtu
refuse 2 'would replace the input' render step_1.vtu step_2.vtu -o s.##.png --stats step_2.vtu $small
refuse 2 'are the same file' render step_1.vtu step_2.vtu -o s.##.png --stats s.01.png $small
mkdir one two
cp step_1.vtu one/7.vtu
cp step_2.vtu two/7.vtu
refuse 2 'more than one input' render one/7.vtu two/7.vtu $small
mkdir 1 2
cp step_1.vtu 1/flow.vtu
cp step_2.vtu 2/flow.vtu
refuse 2 'two of the pictures are the same file' render 1/flow.vtu 2/flow.vtu $small
mkdir report
cp t.json report/time.dat
refuse 2 'would replace --transfer' converge in.vtu -o report --transfer report/time.dat $small --no-plots
rm -r report
accept render in.vtu -o a.png --stats /dev/null --save-scene /dev/null $small # which nothing replaces
"$tetcast" render in.vtu -o a.png $small --stats /dev/stdout --save-scene /dev/stdout >both.txt || fail 'to standard output'
[ "$(grep -c '"rays"\|"camera"' both.txt)" = 2 ] || fail "both to standard output: $(cat both.txt)"
if "$tetcast" --version | grep -q '^adapters:.*tetgen'; then
  cp in.vtu surface.vtu
  refuse 2 'are the same file' mesh surface.vtu -o ./surface.vtu
fi
rm -r one two 1 2

# Modes, and links.
umask 022
for mode in 600 640 666; do
  for name in p.png s.json c.json; do echo old >$name && chmod $mode $name; done
  accept render in.vtu -o p.png --stats s.json --save-scene c.json $small
  for name in p.png s.json c.json; do
    [ "$(stat -c %a $name)" = $mode ] || fail "the mode of $name is $(stat -c %a $name), not $mode"
    [ "$(head -c 3 $name)" != old ] || fail "$name was not written"
  done
done
accept render in.vtu -o new.png $small
[ "$(stat -c %a new.png)" = 644 ] || fail "the mode of a new file is $(stat -c %a new.png)"
ln -s sub/there.png to.png
ln -s sub/there.json to.json
ln -s to.json further.json
accept render in.vtu -o to.png --stats further.json $small
[ -L to.png ] && [ -L to.json ] && [ -L further.json ] || fail 'links were replaced'
exists sub/there.png sub/there.json
ln -s sub/report to-report
accept converge in.vtu -o to-report --size 8x8 --repeat 1 --no-plots
[ -L to-report ] || fail 'the link to a report was replaced'
exists sub/report/report.csv
chmod 700 sub/report
accept converge in.vtu -o to-report --size 8x8 --repeat 1 --no-plots
[ "$(stat -c %a sub/report)" = 700 ] || fail "the mode of a report is $(stat -c %a sub/report), not 700"
if "$tetcast" --version | grep -q '^adapters:.*tetgen'; then
  printf '%s\n' OFF '4 4 0' '0 0 0' '1 0 0' '0 1 0' '0 0 1' '3 0 2 1' '3 0 1 3' '3 1 2 3' '3 0 3 2' >body.off
  ln -s sub/body.vtu to.vtu
  accept mesh body.off -o to.vtu
  [ -L to.vtu ] || fail 'the link to a mesh was replaced'
  exists sub/body.vtu
  chmod 600 sub/body.vtu
  accept mesh body.off -o to.vtu
  [ "$(stat -c %a sub/body.vtu)" = 600 ] || fail "the mode of a mesh is $(stat -c %a sub/body.vtu), not 600"
fi
find . -name '.tetcast*' | grep . && fail 'temporary files are left'

# What killed runs have left goes with the next run; what another run is writing does not, nor does anything else.
leave() { # the left-overs of a process that is gone
  echo x >.tetcast-999999999-0.png
  echo x >.tetcast-1-17.json # of a process of that number, which has no lock
  echo x >.tetcast-12-0
  mkdir -p .tetcast-77-3
  echo x >.tetcast-77-3/report.md
}
kept='.tetcast-1 .tetcast-x-1.png .tetcast-1-x .tetcast-1-2x .tetcast.png .tetcast-- tetcast-1-2.png'
for name in $kept; do echo x >"$name"; done
mkdir -p .tetcast-5-6/folder
for command in "render in.vtu -o a.png $small" 'converge in.vtu -o other-report --size 8x8 --repeat 1 --no-plots' \
  "render in.vtu -o sub/a.png --stats ./a.json $small"; do
  leave
  # shellcheck disable=SC2086  # a list of words
  accept $command
  [ -z "$(ls -d .tetcast-999999999-0.png .tetcast-1-17.json .tetcast-12-0 .tetcast-77-3 2>/dev/null)" ] ||
    fail "left-overs stay: $(ls -A | grep '^.tetcast-[0-9]*-[0-9]'): $command"
  # shellcheck disable=SC2086
  exists $kept
done
[ -d .tetcast-5-6/folder ] || fail 'a folder that is none of ours was removed'
rm -r .tetcast-5-6
if command -v flock >/dev/null; then
  leave
  flock .tetcast-12-0 flock .tetcast-77-3 "$tetcast" render in.vtu -o a.png $small || fail 'beside another run'
  exists .tetcast-12-0 .tetcast-77-3/report.md
  [ ! -e .tetcast-999999999-0.png ] || fail 'beside another run, left-overs stay'
fi
accept render in.vtu -o a.png $small
# shellcheck disable=SC2086
rm $kept

# Killed wherever it writes: the former file or the new one is there, and the next run leaves nothing.
if command -v strace >/dev/null && strace -qq -o /dev/null true 2>/dev/null; then
  export ASAN_OPTIONS="${ASAN_OPTIONS:+$ASAN_OPTIONS:}detect_leaks=0"
  killed() { # SYSTEM-CALL NUMBER ARGUMENTS…
    local call=$1 number=$2
    shift 2
    (
      strace -f -qq -o /dev/null -e trace="$call" -e inject="$call:signal=KILL:when=$number" "$tetcast" "$@"
      true # the shell that waits tells of its child's end
    ) >/dev/null 2>&1
  }
  report="converge in.vtu -o sub/report --size 8x8 --repeat 1 --no-plots --quiet --threads 1"
  # shellcheck disable=SC2086
  "$tetcast" $report
  for call in rename,renameat2 unlink,unlinkat,rmdir; do
    for number in 1 8 9 10; do
      # shellcheck disable=SC2086
      killed $call $number $report
      checks=$((checks + 1))
      exists sub/report/report.md sub/report/report.csv
      [ "$(tail -1 sub/report/report.csv | tr -cd , | wc -c)" = 15 ] || fail "a report in parts: $call $number"
    done
  done
  for number in 1 2; do
    echo old >k.png
    # shellcheck disable=SC2086
    killed rename,unlink $number render in.vtu -o k.png --stats k.json $small
    [ "$(cat k.png 2>/dev/null | head -c 3)" = old ] || [ "$(head -c 4 k.png | tail -c 3)" = PNG ] || fail "a picture in parts: $number"
  done
  [ -n "$(find . -name '.tetcast*')" ] || fail 'nothing was left over: was it killed?'
  # shellcheck disable=SC2086
  accept $report
  # shellcheck disable=SC2086
  accept render in.vtu -o k.png $small
  find . -name '.tetcast*' | grep . && fail 'what killed runs left is there'
fi

# A pipe that nobody reads any more is no fault of the command, nor is a parent that ignores the ends of its children.
"$tetcast" info in.vtu 2>err | true
[ ! -s err ] || fail "a closed pipe: $(cat err)"
ignoring() { # its children inherit it
  env --ignore-signal=CHLD,PIPE "$tetcast" "$@"
}
if env --ignore-signal=CHLD,PIPE true 2>/dev/null && gnuplot --version >/dev/null 2>&1; then
  ignoring converge in.vtu -o plotted --size 8x8 --repeat 1 || fail 'gnuplot with SIGCHLD and SIGPIPE ignored'
  exists plotted/time.png plotted/time.svg
fi
finish
