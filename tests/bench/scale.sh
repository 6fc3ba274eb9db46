#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# scale.sh [--small] [-b BUILD] [-o DIR]: pictures of a mesh in parts on one to four ranks of this machine, and what follows for more of them:
# DIR/scale.csv, a line for each picture, and DIR/model.md. `tetcast_bench_scale` says what the columns are, scale.md what came out.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
build=$here/../../build-werror small='' out=''
while [ $# -gt 0 ]; do
  case $1 in
    --small) small=yes ;;
    -b) build=$2 && shift ;;
    -o) out=$2 && shift ;;
    *)
      echo 'usage: scale.sh [--small] [-b BUILD] [-o DIR]' >&2
      exit 2
      ;;
  esac
  shift
done
out=${out:-$build/bench}
mkdir -p "$out"
program=$build/bin/tetcast_bench_scale

# For Open MPI, 4 and 5: as root, with more ranks than processors, without a network.
export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 OMPI_MCA_rmaps_base_oversubscribe=1
export PRTE_MCA_rmaps_default_mapping_policy=:oversubscribe OMPI_MCA_hwloc_base_binding_policy=none PRTE_MCA_hwloc_default_binding_policy=none
export OMPI_MCA_pml=ob1 OMPI_MCA_btl=self,vader OMPI_MCA_btl_vader_single_copy_mechanism=none OMPI_MCA_mpi_yield_when_idle=1

processors=$(nproc)
csv=$out/scale.csv
{
  echo "# $(sed -n 's/^model name[^:]*: //p' /proc/cpuinfo | head -n 1), $processors processors"
  "$program" | tr ' ' ','
} >"$csv"

# picture KIND RANKS N SIZE PARTITION PIECES
picture() {
  threads=$((processors / $2))
  [ $threads -gt 0 ] || threads=1
  timeout 900 mpirun -n "$2" "$program" "$3" "$4" "$5" "$6" $threads >"$out/line"
  tail -n 1 "$out/line" | tr ' ' ',' >>"$csv"
  printf '%-7s %s\n' "$1" "$(tail -n 1 "$out/line")"
}

most=4 strong=96 scattered=24 size=1024 weak='64 81 92 102' pieces=64 pieces_size=256 counts='1 8 27 64 125 216 343 512'
if [ -n "$small" ]; then
  most=2 strong=6 scattered=5 size=64 weak='5 6' pieces=10 pieces_size=32 counts='1 8 27'
fi
echo "        $("$program")"
for partition in boxes wavy scatter; do
  for ranks in $(seq $most); do
    n=$strong
    [ $partition != scatter ] || n=$scattered # as each ray has a fragment for every second cell or so
    picture strong "$ranks" $n $size $partition "$ranks"
  done
done
for partition in boxes wavy; do
  ranks=0
  for n in $weak; do
    ranks=$((ranks + 1))
    picture weak $ranks "$n" $size $partition $ranks
  done
done
for partition in boxes wavy scatter; do
  for count in $counts; do
    [ $partition != scatter ] || [ "$count" -le 64 ] || continue
    picture pieces 1 $pieces $pieces_size $partition "$count"
  done
done
rm -f "$out/line"

# Fragments per ray are taken as a · P^⅓, a from the pictures of many pieces. A pixel's fragments have 56 bytes each. Ranks send and receive
# their share of them, but for what they own themselves, and 32 bytes a pixel go to rank 0. The network: 10 GB/s for each rank's node.
awk -F, -v bytes=56 -v width=3840 -v height=2160 -v speed=10e9 -v share=0.5 '
  /^partition/ { for (i = 1; i <= NF; ++i) column[$i] = i; next }
  /^#/ { print "Measured on" substr($0, 2) "."; next }
  $column["ranks"] == 1 && $column["pieces"] > 1 && $column["partition"] != "scatter" {
    p = $column["pieces"]; x = p ^ (1 / 3); xx[$1] += x * x; xy[$1] += x * $column["fragments_per_ray"]
  }
  END {
    printf "\nA picture of %d × %d pixels, of which the mesh fills %.0f %%; a part on each rank.\n\n", width, height, 100 * share
    print "| partition | a | ranks | fragments per ray | all fragments, GB | sent by a rank, MB | its exchange, ms | to rank 0, MB | ms |"
    print "| --- | --- | --- | --- | --- | --- | --- | --- | --- |"
    for (name in xx) {
      a = xy[name] / xx[name]
      for (ranks = 64; ranks <= 16384; ranks *= 4) {
        f = a * ranks ^ (1 / 3); all = f * width * height * share * bytes; each = all / ranks; frame = width * height * 32
        printf "| %s | %.2f | %d | %.1f | %.2f | %.2f | %.2f | %.0f | %.1f |\n", name, a, ranks, f, all / 1e9, each / 1e6,
          2e3 * each / speed, frame / 1e6, 1e3 * frame / speed
      }
    }
  }' "$csv" >"$out/model.md"
cat "$out/model.md"
