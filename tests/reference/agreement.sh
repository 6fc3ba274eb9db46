#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# agreement.sh TETCAST REFERENCE MESH [ARRAY [CASE…]]: renders MESH with the walk, with all faces, and by brute force,
# which must be the same within 1e-12; the first case with two threads as well, to the last bit. A ray that grazes an
# opaque step so flatly that the last bits of a coordinate matter may differ by as much as these do; of a thousand
# pixels one at most.
# A case is VIEW-TRANSFER; VIEW-direct is by --extinction and --emission of an ARRAY ≥ 0.
# TETCAST_TEST_LONG=1: every view with every transfer function, every pixel, however many such rays there are.
set -u -o pipefail
tetcast=$1 reference=$2 mesh=$3 array=${4-}
shift $(($# < 4 ? $# : 4))
views=(default oblique ortho inside cut)
transfers=(preset peaks steps opacity)
cases=("$@")
if [ -n "${TETCAST_TEST_LONG-}" ]; then
  for view in "${views[@]}"; do
    for transfer in "${transfers[@]}"; do cases+=("$view-$transfer"); done
  done
elif [ ${#cases[@]} = 0 ]; then
  cases=(default-preset oblique-peaks ortho-steps inside-opacity)
fi
if [ ! -e "$mesh" ]; then
  mesh=${TETCAST_DATA-}/$mesh
  if [ ! -e "$mesh" ]; then
    echo "skipped: there is no $mesh"
    exit 77
  fi
fi
mesh=$(realpath "$mesh")
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder" || exit 1
failures=0

run() { # COMMAND…: its output is shown only if it fails
  if ! "$@" >log 2>&1; then
    echo "FAILED: $*"
    cat log
    failures=$((failures + 1))
    return 1
  fi
}

# What the cameras and transfer functions below are made from.
base=("$tetcast" render "$mesh" --quiet)
if [ -n "$array" ]; then base+=(--array "$array"); fi
run "${base[@]}" --size 8x6 -o first.tif --save-scene first.json || exit 1
read -r x0 x1 y0 y1 z0 z1 low high px py pz cells <<<"$("$reference" --describe first.json)" || exit 1
number() { awk "BEGIN { printf \"%.17g\", $1 }" </dev/null; }
vector() { echo "$(number "$1"),$(number "$2"),$(number "$3")"; }
center() { vector "($x0+$x1)/2+($1)" "($y0+$y1)/2+($2)" "($z0+$z1)/2+($3)"; } # from the middle
size=$(number "sqrt(($x1-($x0))^2+($y1-($y0))^2+($z1-($z0))^2)")
at() { number "$low+($1)*($high-($low))"; } # a part of the range

# Brute force takes its time: of large meshes, each so-many-th pixel, no divisor of the width.
every=$((cells / 15000 + 1))
while [ $every -gt 1 ] && { [ $((every % 2)) = 0 ] || [ $((every % 3)) = 0 ]; }; do every=$((every + 1)); done
if [ -n "${TETCAST_TEST_LONG-}" ]; then every=1; fi

cat >peaks.json <<END
{"color": [[$(at 0), 0.1, 0.2, 0.9], [$(at 0.33), 0.9, 0.9, 0.3], [$(at 0.71), 1, 0.1, 0], [$(at 1), 0.5, 0, 0.5]],
 "extinction": [[$(at 0.02), 0], [$(at 0.05), $(number "40/$size")], [$(at 0.08), 0],
   [$(at 0.3), $(number "0.2/$size")], [$(at 0.31), $(number "150/$size")], [$(at 0.32), 0],
   [$(at 0.6), 0], [$(at 0.62), $(number "90/$size")], [$(at 0.64), $(number "1/$size")]]}
END
cat >steps.json <<END
{"color": [[$(at 0.3), 1, 0.5, 0], [$(at 0.3), 0.2, 0.6, 1], [$(at 0.75), 0.3, 0.9, 0.2], [$(at 0.75), 1, 1, 1]],
 "extinction": [[$(at 0.1), 0], [$(at 0.1), $(number "1/$size")], [$(at 0.45), $(number "4/$size")],
   [$(at 0.45), $(number "2000/$size")], [$(at 0.5), $(number "2000/$size")], [$(at 0.5), 0]]}
END
cat >whole.json <<END
{"color": [[0, 1, 0, 0], [1, 1, 0, 0], [1, 0, 1, 0], [2, 0, 1, 1], [2, 0, 0, 1]],
 "extinction": [[0, 0], [0, $(number "1/$size")], [1, $(number "2/$size")], [1, $(number "9/$size")],
   [2, $(number "9/$size")], [2, $(number "3/$size")]]}
END
cat >opacity.json <<END
{"color": [[$(at 0), 0, 0, 1], [$(at 0.5), 1, 1, 1], [$(at 1), 1, 0, 0]],
 "opacity": [[$(at 0), 0.05], [$(at 0.4), 0.02], [$(at 0.7), 0.6], [$(at 1), 1]], "unit_distance": $(number "$size/5")}
END

# White, of an extinction that is the array itself: what the array as both extinction and emission must look like.
cat >direct.json <<END
{"color": [[$low, 1, 1, 1]], "extinction": [[$low, $low], [$high, $high]]}
END

options_of() { # CASE
  case ${1%-*} in
    default) ;;
    odd) echo "--size 97x73" ;; # the middle column and row of pixels look along planes of symmetry
    oblique)
      echo "--eye $(center "0.9*$size" "0.7*$size" "1.1*$size") --target $(center "0.05*$size" 0 0)"
      echo "--up 0.1,0.9,-0.2 --fovy 41.5"
      ;;
    diagonal) echo "--eye $(center 3 3 3) --target $(center 0 0 0) --up 0,0,1 --fovy 20 --size 61x61" ;;
    ortho)
      echo "--eye $(center "-0.8*$size" "0.3*$size" "0.55*$size") --target $(center 0 0 0)"
      echo "--up 0,0,1 --ortho $(number "0.9*$size")"
      ;;
    aligned) # sixteenths of the cube, faces, edges and vertices of its cells among them
      echo "--eye $(center 0 0 3) --target $(center 0 0 0) --up 0,1,0"
      echo "--ortho $(number "15/16*($y1-($y0))") --size 15x15"
      ;;
    cut) # by an oblique plane and to a box, of which one side lies across the middle
      echo "--eye $(center "0.9*$size" "0.7*$size" "1.1*$size") --target $(center "0.05*$size" 0 0) --up 0.1,0.9,-0.2 --fovy 41.5"
      echo "--clip -0.4,0.7,-0.5,$(number "-0.4*($x0+$x1)/2+0.7*($y0+$y1)/2-0.5*($z0+$z1)/2-0.05*$size")"
      echo "--clip-box $(vector "($x0+$x1)/2" "$x1+$size" "$y0-$size"),$(vector "$y0+0.9*($y1-($y0))" "$z0-1e9*$size" "$z1+$size")"
      ;;
    inside)
      echo "--eye $px,$py,$pz --target $(vector "$px+0.3*$size" "$py-0.2*$size" "$pz+0.1*$size")"
      echo "--up 0,1,0 --fovy 75"
      ;;
  esac
  [ "${1#*-}" = preset ] || echo "--transfer ${1#*-}.json"
}

check() { # CASE
  local -a options
  read -r -d '' -a options <<<"--size 96x72 $(options_of "$1")"
  local render=("${base[@]}" "${options[@]}" --pixel-type double)
  run "${render[@]}" --traversal shell --threads 1 -o one.tif --save-scene scene.json || return
  if [ "${1#*-}" = direct ]; then
    read -r -d '' -a options <<<"--size 96x72 $(options_of "${1%-*}-preset")"
    render=("$tetcast" render "$mesh" --quiet "${options[@]}" --extinction "$array" --emission "$array" --pixel-type double)
    run "${render[@]}" --traversal shell --threads 1 -o one.tif || return
  fi
  run "${render[@]}" --traversal faces --threads 2 -o faces.tif || return
  if [ "$1" = "${cases[0]}" ]; then
    run "${render[@]}" --traversal shell --threads 2 -o two.tif || return
    cmp one.tif two.tif || { echo "FAILED: $1: one thread and two" && failures=$((failures + 1)); }
  fi
  local brute_force=("$reference" scene.json one.tif faces.tif --every "$every" --condition)
  [ "${1#*-}" = preset ] || brute_force+=(--transfer "${1#*-}.json")
  if ! run "${brute_force[@]}"; then
    echo "^ image by ${render[*]}, other with --traversal faces"
    [ "${1#*-}" = preset ] || cat "${1#*-}.json"
  elif [ -z "${TETCAST_TEST_LONG-}" ] &&
    ! awk '/, [0-9]+ pixels:$/ { count = $(NF - 1) } / pixels beyond / && 1000 * $1 > count { bad = 1 } END { exit bad }' log; then
    echo "FAILED: $1: differs in more than a pixel of a thousand"
    cat log
    failures=$((failures + 1))
  fi
  echo "$1: $(tail -n 1 log)"
  if grep -q 'average alpha 0.000' log; then empty=$((empty + 1)); fi
}

empty=0
for case in "${cases[@]}"; do check "$case"; done
if [ $((3 * empty)) -gt ${#cases[@]} ]; then
  echo "FAILED: $empty of ${#cases[@]} pictures show nothing"
  failures=$((failures + 1))
fi
[ $failures = 0 ]
