# SPDX-License-Identifier: Apache-2.0
# render --mpi: pieces over ranks are the picture of the whole, with the same bits for any number of ranks; and whatever
# fails on one rank ends all of them, with one line that says why.
here=$(realpath "$(dirname "$0")")
. "$here/lib.sh"
needs vtk openimageio mpi
if ! command -v mpirun >/dev/null || ! command -v python3 >/dev/null; then
  echo 'skipped: no mpirun or no python3'
  exit 77
fi
launch=mpirun
if mpirun --version 2>&1 | grep -q 'Open MPI'; then
  launch='mpirun --allow-run-as-root --oversubscribe --bind-to none'
  export OMPI_MCA_mpi_yield_when_idle=1
fi

# over RANKS CODE ARGUMENTS…: the exit code is CODE, and no rank hangs; what tetcast says goes to $said, without notes.
over() {
  local ranks=$1 code=$2 got
  shift 2
  checks=$((checks + 1))
  timeout 100 $launch -n "$ranks" "$tetcast" render --mpi --threads 1 "$@" >"$work.out" 2>"$work.err"
  got=$?
  [ "$got" = "$code" ] || fail "exit code $got instead of $code over $ranks ranks: $(cat "$work.err"): $*"
  [ ! -s "$work.out" ] || fail "standard output: $(head -c 200 "$work.out"): $*"
  said=$(grep '^tetcast: ' "$work.err" | grep -v '^tetcast: note: ')
}

# fine RANKS ARGUMENTS…: nothing is said.
fine() {
  over "$1" 0 "${@:2}"
  [ -z "$said" ] || fail "said: $said: $*"
}

# fault RANKS CODE TEXT ARGUMENTS…: one line is said, an error with TEXT in it, and no file appears, changes or goes.
fault() {
  local text=$3 before after
  before=$(find . -printf '%p %s\n')
  over "$1" "$2" "${@:4}"
  after=$(find . -printf '%p %s\n')
  [[ $said = 'tetcast: error: '*"$text"* && $said != *$'\n'* ]] || fail "'$text' is not what is said: $said: ${*:4}"
  [ "$before" = "$after" ] || fail "files changed: $(diff <(echo "$before") <(echo "$after")): ${*:4}"
}

# warned RANKS TEXT ARGUMENTS…
warned() {
  over "$1" 0 "${@:3}"
  [[ $said = *'tetcast: warning: '*"$2"* ]] || fail "no warning '$2' in '$said': ${*:3}"
}

# near A B BOUND: two pictures of doubles differ by no more than that.
near() {
  local difference
  checks=$((checks + 1))
  difference=$(python3 "$here/pieces.py" differ "$1" "$2") || fail "$1 and $2 can't be compared"
  awk "BEGIN { exit !($difference <= $3) }" || fail "$1 and $2 differ by $difference${4:+: $4}"
}

cat >t.json <<'END_OF_JSON'
{"color": [[-1, 0.1, 0.2, 0.8], [0, 0.9, 0.9, 0.9], [2, 0.8, 0.1, 0.1]],
 "extinction": [[-1, 6], [0, 0], [0.5, 3], [2, 9]]}
END_OF_JSON
small='--size 60x50'
exact="$small --pixel-type double --array s --transfer t.json"

# Pieces of any shape are the whole, with ghosts and without; ranks without pieces; a file that is split.
for partition in boxes scattered; do
  python3 "$here/pieces.py" make tetrahedra 5 $partition
  accept render whole.vtu $exact -o whole.tif
  for ranks in 1 2 4 7; do
    fine $ranks plain.pvtu $exact -o $ranks.tif
    same 1.tif $ranks.tif "$ranks ranks, $partition"
  done
  near whole.tif 1.tif 5e-15 $partition
  fine 3 ghosts.pvtu $exact -o ghosts.tif
  near whole.tif ghosts.tif 5e-15 "ghosts, $partition"
done
for ranks in 1 2 4; do
  fine $ranks whole.vtu $exact -o s$ranks.tif
done
same s1.tif s2.tif 'a file that is split, on 2 ranks'
same s1.tif s4.tif 'a file that is split, on 4 ranks'
near whole.tif s1.tif 5e-15 'a file that is split'
near whole.tif s4.tif 5e-15 'a file that is split over 4 ranks'
for view in '--eye 0.45,0.5,0.55 --target 1,0.3,0.2' '--ortho 0.4 --view +x' '--zoom 5 --azimuth 200'; do
  accept render whole.vtu $exact $view -o w.tif
  fine 2 plain.pvtu $exact $view -o m.tif
  near w.tif m.tif 5e-15 "$view"
done
accept render whole.vtu $exact --array c -o cells.tif
fine 3 plain.pvtu $exact --array c -o c.tif
near cells.tif c.tif 5e-15 'values of cells'
fine 2 whole.vtu $exact --array c -o c.tif
near cells.tif c.tif 5e-15 'values of cells, split'
accept render whole.vtu $exact --clip 1,1,0,0.8 -o clip.tif
fine 3 plain.pvtu $exact --clip 1,1,0,0.8 -o c.tif
near clip.tif c.tif 5e-15 'a clip'
warned 2 'parts of the mesh overlap by up to' unmarked.pvtu $exact -o unmarked.tif

# What is found from the values is found from those of all: the transfer function, the camera, what is drawn round the
# picture, the range; and so is what the statistics and the scene say.
bits=$small\ '--pixel-type double --array s'
for options in '' '--range 1%,99%' '--log' '--centre 0.3' '--array c'; do
  "$tetcast" render whole.vtu $bits $options -o w.tif 2>/dev/null
  over 3 0 plain.pvtu $bits $options -o m.tif
  near w.tif m.tif 1e-9 "found from the values: $options"
done
accept render whole.vtu $small -o w.png --save-scene w.json --stats w.stats
fine 3 plain.pvtu $small -o m.png --save-scene m.json --stats m.stats
exists m.png m.json
for key in rays tetrahedra array why scale; do
  same <(grep "\"$key\"" w.stats) <(grep "\"$key\"" m.stats) "statistics: $key"
done
output=$(cat m.stats)
for key in '"count": 3' '"parts": 5' '"fragments": [1-9]' '"overlap": (0.0|[0-9.]+e-1[5-7])' '"bytes": [1-9]' \
  '"exchange_seconds": ' '"composite_seconds": ' '"gather_seconds": ' '"most_peak_rss_bytes": [1-9]'; do
  contains "$key"
done
accept render --scene m.json $small -o again.png
checks=$((checks + 1))
! grep -q mpi m.json || fail 'a scene says how it was made'
refuse 1 "unknown key 'mpi'" render --scene <(echo '{"input": "whole.vtu", "mpi": true}')

# What has no arrays is uniform matter.
python3 "$here/pieces.py" make tetrahedra 5 boxes none
"$tetcast" render whole.vtu $small --pixel-type double -o w.tif 2>/dev/null
warned 3 'has no arrays: drawn as uniform matter' plain.pvtu $small --pixel-type double -o m.tif
near w.tif m.tif 1e-9 'uniform matter'
warned 2 'has no arrays: drawn as uniform matter' whole.vtu $small --pixel-type double -o m.tif
near w.tif m.tif 1e-9 'uniform matter of a file that is split'

# Labels have a colour each, whichever rank has them.
python3 "$here/pieces.py" make tetrahedra 5 boxes labels
for options in '' '--label 2:red:0.9' '--array material --preset inferno'; do
  "$tetcast" render whole.vtu $small --pixel-type double $options -o w.tif 2>/dev/null
  for mesh in plain.pvtu whole.vtu; do
    over 3 0 $mesh $small --pixel-type double $options -o m.tif
    near w.tif m.tif 1e-9 "labels of $mesh: $options"
  done
done

# Fewer cells than parts.
vtu cube.vtu "$five_tetrahedra" 10
accept render cube.vtu $small --pixel-type double -o w.tif
fine 3 cube.vtu $small --pixel-type double -o m.tif
near w.tif m.tif 1e-9 'five cells'

# Coefficients, with what they have for each group.
python3 "$here/pieces.py" make tetrahedra 5 scattered groups
direct="$small --pixel-type double --extinction k --emission j --groups --channels"
for channels in radiance,optical_depth,transmittance,path_length transmittance; do
  accept render whole.vtu $direct $channels -o whole.tif
  for ranks in 1 3; do
    fine $ranks plain.pvtu $direct $channels -o $ranks.tif
  done
  same 1.tif 3.tif "groups: $channels"
  near whole.tif 1.tif 5e-14 "groups: $channels"
  fine 2 whole.vtu $direct $channels -o split.tif
  near whole.tif split.tif 5e-14 "groups of a file that is split: $channels"
done
for options in '--extinction k:3' '--emission j:0' '--extinction k:mag --channels path_length'; do
  accept render whole.vtu $small --pixel-type double $options -o w.tif
  fine 3 ghosts.pvtu $small --pixel-type double $options -o m.tif
  near w.tif m.tif 5e-14 "coefficients: $options"
done
fault 2 1 'the channel error is not possible with parts on several ranks' plain.pvtu $direct error -o no.tif
fault 3 1 "has no array 'none'" plain.pvtu $small --extinction none -o no.png

python3 "$here/pieces.py" make hexahedra 4 boxes
# Hexahedra, whose pieces number their points each in its way: none cuts a face otherwise than its neighbour.
fine 1 plain.pvtu $exact -o h1.tif --stats h.stats
output=$(cat h.stats)
contains '"overlap": (0.0|[0-9.]+e-1[5-7])'
for ranks in 2 3; do
  fine $ranks plain.pvtu $exact -o h.tif
  same h1.tif h.tif "hexahedra over $ranks ranks"
done
fine 3 ghosts.pvtu $exact -o h.tif
near h1.tif h.tif 5e-15 'hexahedra with ghosts'

# What fails.
python3 "$here/pieces.py" make tetrahedra 5 boxes
cp plain_3.vtu kept.vtu
rm plain_3.vtu
fault 3 1 'plain_3.vtu' plain.pvtu -o no.png
head -c 5000 kept.vtu >plain_3.vtu
fault 3 1 'plain_3.vtu' plain.pvtu -o no.png
fault 3 1 'plain_3.vtu' plain.pvtu -o no.png --array s
sed 's/Name="s"/Name="other"/' kept.vtu >plain_3.vtu
warned 3 "has no array 's'" plain.pvtu $exact -o lack.tif
fault 3 1 "has no array 's'" plain.pvtu $exact -o no.tif --strict
cp kept.vtu plain_3.vtu
fault 3 1 "has no array 'nothing'" plain.pvtu --array nothing -o no.png
fault 3 1 'no.pvtu' no.pvtu -o no.png
fault 3 1 'its folder does not exist' plain.pvtu -o nowhere/no.png
fault 3 1 'its folder does not exist' plain.pvtu -o no.png --stats nowhere/no.json
fault 3 1 'no.json' plain.pvtu -o no.png --transfer no.json
fault 3 2 'unknown or ambiguous option --nothing' plain.pvtu -o no.png --nothing
fault 3 2 '--mpi: for one picture' plain.pvtu -o no.png --orbit 3
fault 3 2 '--mpi: for one picture' plain.pvtu -o no.png --time all
fault 3 2 '--mpi: not possible with --deep' plain.pvtu -o no.exr --deep
checks=$((checks + 1))
timeout 100 $launch -n 2 "$tetcast" render plain.pvtu $small --array s -o forgotten.png 2>"$work.err"
[ "$(grep -c 'this is one of 2 processes, each of which makes the whole picture; --mpi shares it out' "$work.err")" = 1 ] ||
  fail "--mpi is forgotten: $(cat "$work.err")"
fault 2 1 'parts of a mesh: not possible with' plain.pvtu -o no.png --blend maximum
fault 2 1 'parts of a mesh: not possible with' plain.pvtu -o no.png --samples 4
fault 2 1 '--cell-to-point and --merge-tolerance' plain.pvtu -o no.png --cell-to-point
fault 2 2 'eye' plain.pvtu -o no.png --eye 0.5,0.5,0.5 --target 0.5,0.5,0.5
over 2 1 plain.pvtu $small -o full.png --stats /dev/full
[[ $said = *"'/dev/full'"* && $said != *$'\n'* ]] || fail "a full disk: $said"
warned 2 'the picture shows nothing: the mesh lies behind the camera' plain.pvtu $small -o behind.png \
  --eye 3,0,0 --target 6,0,0

# Without mpirun, there is one rank.
accept render --mpi plain.pvtu $exact -o alone.tif
fine 2 plain.pvtu $exact -o 2.tif
same 2.tif alone.tif 'without mpirun'

# Without the adapter, one line says so.
mkdir -p bare/bin bare/lib
cp "$tetcast" bare/bin
cp "$(dirname "$tetcast")"/../lib/libtetcast.so.* bare/lib
checks=$((checks + 1))
said=$(bare/bin/tetcast render --mpi plain.pvtu -o no.png 2>&1)
[ $? = 1 ] || fail 'exit code without the adapter'
[[ $said = 'tetcast: error: --mpi needs the adapter libtetcast-mpi.so'*'cannot be loaded'* && $said != *$'\n'* ]] ||
  fail "without the adapter: $said"

# A signal to one rank, or to all, ends all of them, and leaves nothing behind.
for target in rank all; do
  checks=$((checks + 1))
  before=$(files)
  timeout 100 $launch -n 3 "$tetcast" render --mpi --threads 1 plain.pvtu -o no.png --repeat 100000 >/dev/null 2>"$work.err" &
  launched=$!
  for _ in {1..100}; do # until they are there, and at work
    sleep 0.1
    mpirun=$(pgrep -P $launched 2>/dev/null | head -n 1)
    ranks=($(pgrep -P "${mpirun:-0}" -x tetcast 2>/dev/null))
    [ ${#ranks[@]} = 3 ] && break
  done
  sleep 1
  if [ $target = rank ]; then kill -TERM "${ranks[2]}"; else kill -INT "$mpirun"; fi
  wait $launched
  got=$?
  [ $got != 0 ] && [ $got != 124 ] || fail "exit code $got after a signal to $target"
  [ "$before" = "$(files)" ] || fail "a signal to $target leaves $(diff <(echo "$before") <(files))"
done
finish
