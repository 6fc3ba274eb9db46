# SPDX-License-Identifier: Apache-2.0
# tetcast mesh: what it makes, and what it says to surfaces that can't be filled.
. "$(dirname "$0")/../cli/lib.sh"
needs vtk tetgen

# A cube of edge 2 in several formats; box.smesh has a cavity of volume 1/48.
points='0 0 0|2 0 0|2 2 0|0 2 0|0 0 2|2 0 2|2 2 2|0 2 2'
triangles='0 2 1|0 3 2|4 5 6|4 6 7|0 1 5|0 5 4|1 2 6|1 6 5|2 3 7|2 7 6|3 0 4|3 4 7'
lines() { tr '|' '\n' <<<"$1"; }
off() { # FILE POINTS TRIANGLES
  {
    printf 'OFF\n%d %d 0\n' "$(lines "$2" | wc -l)" "$(lines "$3" | wc -l)"
    lines "$2"
    lines "$3" | sed 's/^/3 /'
  } >"$1"
}
off cube.off "$points" "$triangles"
{
  printf 'ply\nformat ascii 1.0\nelement vertex 8\nproperty double x\nproperty double y\nproperty double z\n'
  printf 'element face 12\nproperty list uchar int vertex_indices\nend_header\n'
  lines "$points"
  lines "$triangles" | sed 's/^/3 /'
} >cube.ply
{
  lines "$points" | sed 's/^/v /'
  lines "$triangles" | while read -r a b c; do echo "f $((a + 1)) $((b + 1)) $((c + 1))"; done
} >cube.obj
corner() { lines "$points" | sed -n "$(($1 + 1))p"; }
{
  echo 'solid cube'
  lines "$triangles" | while read -r a b c; do
    printf 'facet normal 0 0 0\nouter loop\nvertex %s\nvertex %s\nvertex %s\nendloop\nendfacet\n' \
      "$(corner "$a")" "$(corner "$b")" "$(corner "$c")"
  done
  echo 'endsolid cube'
} >cube.stl
float() { case $1 in 0) printf '\0\0\0\0' ;; *) printf '\0\0\0\100' ;; esac; } # 0 or 2
{
  head -c 80 /dev/zero
  printf '\14\0\0\0'
  lines "$triangles" | while read -r a b c; do
    for x in 0 0 0 $(corner "$a") $(corner "$b") $(corner "$c"); do float "$x"; done
    printf '\0\0'
  done
} >binary.stl
{
  printf '12 3 0 0\n'
  lines "$points" | cat -n | while read -r i rest; do echo "$((i - 1)) $rest"; done
  printf '8 .5 .5 .5\n9 1 .5 .5\n10 .5 1 .5\n11 .5 .5 1\n10 0\n'
  printf '4 0 1 2 3\n4 4 5 6 7\n4 0 1 5 4\n4 1 2 6 5\n4 2 3 7 6\n4 3 0 4 7\n'
  printf '3 8 9 10\n3 8 9 11\n3 9 10 11\n3 8 10 11\n1\n0 .6 .6 .6\n'
} >box.smesh

volume() { # FILE VOLUME
  accept info "$1"
  contains "volume +$2"
  contains 'components +1'
  contains 'inverted cells +0'
}
for file in cube.off cube.ply cube.obj cube.stl binary.stl; do
  accept mesh $file -o a.vtu
  contains '^a.vtu: [0-9]+ vertices, [0-9]+ tetrahedra, worst radius-edge ratio [0-9.]+$'
  volume a.vtu '(8|8.00000000|7.99999999)'
done
accept mesh box.smesh -o b.vtu --max-volume 0.01
volume b.vtu 7.9791666
accept mesh cube.off -o q.vtu --quality 0
contains ' 8 vertices'
accept mesh cube.off -o q.vtu --quiet --single
[ -z "$output" ] || fail "--quiet, but: $output"
printf '5 3\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n5 1 1 1\n' >two.node
printf '2 4 0\n1 1 2 3 4\n2 2 3 5 4\n' >two.ele
for end in node ele; do
  accept mesh two.$end -o two.vtu
  contains ' 5 vertices, 2 tetrahedra'
done

# Fields.
range() { # FIELD RANGE [SURFACE]
  accept mesh "${3:-cube.off}" -o f.vtu --max-volume 0.02 --field "$1"
  accept info f.vtu
  contains "point +${1%%:*} +float64 +\[$2\]"
}
range linear '0, 2'
range linear:1,-2,3 '-4, 8'
range radius '0, 3.46410162'
range radius:2,0,0 '0, 3.46410162'
range gaussians '[0-9.e-]+, [0-9.]+'
range gaussians:1,0.1,7 '[0-9.e-]+, 0?[0-9.e-]+'
range gyroid '-1.[0-9]+, 1.[0-9]+'
range hydrogen:1,0,0 '0.00031[0-9]+, 0.318309886' # e^−2r / π
range orbital:2,1,0,0.5 '0, [0-9.]+'
range shell:3,2 '[-0-9.e]+, [-0-9.e]+'
range heat '0, 1' box.smesh
range glow '0, 1'
range flow '(1|0.99999999[0-9]*), (1|1.0000000[0-9]*)' # nothing in the way
accept mesh cube.off -o s.vtu --field linear --single
accept info s.vtu
contains 'linear +float32'
refuse 1 'cavities' mesh cube.off -o f2.vtu --field heat

# Surfaces that can't be filled.
open_cube=${triangles%|*}
off open.off "$points" "$open_cube"
refuse 1 'open.off: the surface is open: 3 edges have only one triangle' mesh open.off -o x.vtu
off nan.off "${points/2 2 2/2 nan 2}" "$triangles"
refuse 1 'nan.off' mesh nan.off -o x.vtu
off crossed.off "${points/0 0 0/0.5 0.6 3}" "$triangles"
refuse 1 'crossed.off: the surface intersects itself' mesh crossed.off -o x.vtu
off flat.off "${points//2|/0|}" "$triangles"
refuse 1 'flat.off' mesh flat.off -o x.vtu
off thin.off '0 0 0|1 0 0|0 1 0|.3 .3 1e-7' '0 2 1|0 1 3|1 2 3|2 0 3' # TetGen 1.5 ends its process on it
refuse 1 'thin.off: TetGen gave up on it (Aborted)' mesh thin.off -o x.vtu
off range.off "$points" "${triangles/7/8}"
refuse 1 'range.off' mesh range.off -o x.vtu
for file in cube.off cube.ply cube.obj cube.stl binary.stl box.smesh two.ele; do
  head -c $(($(wc -c <$file) * 2 / 3)) $file >cut.${file##*.}
  [ "$file" = two.ele ] && cp two.node cut.node
  refuse 1 "cut.${file##*.}" mesh cut.${file##*.} -o x.vtu
done
rm -f cut.*
for end in off ply obj stl vtp poly smesh node ele; do
  head -c 3000 "$tetcast" >noise.$end
  : >empty.$end
  refuse 1 . mesh noise.$end -o x.vtu
  refuse 1 "empty." mesh empty.$end -o x.vtu
  refuse 1 missing mesh missing.$end -o x.vtu
done
refuse 1 'more than 536870911' mesh cube.off -o x.vtu --max-volume 1e-20

# Outputs.
refuse 1 nowhere mesh cube.off -o nowhere/x.vtu
mkdir -p folder.vtu
refuse 1 folder.vtu mesh cube.off -o folder.vtu
echo old >old.vtu
refuse 1 open mesh open.off -o old.vtu

# Usage.
refuse 2 'no surface' mesh -o x.vtu
refuse 2 'no output' mesh cube.off
refuse 2 'expected the name of a .vtu' mesh cube.off -o x.png
refuse 2 'more than one surface' mesh cube.off cube.stl -o x.vtu
refuse 2 --bogus mesh cube.off -o x.vtu --bogus
for value in 1 0.5 -1 nan x ''; do refuse 2 --quality mesh cube.off -o x.vtu --quality "$value"; done
for value in -1 inf x ''; do refuse 2 --max-volume mesh cube.off -o x.vtu --max-volume "$value"; done
for value in bogus '' : linear: linear:1 linear:1,2 linear:1,2,3,4 linear:a,b,c hydrogen hydrogen:1 hydrogen:1,1,0 \
  hydrogen:0,0,0 hydrogen:2,1,2 hydrogen:2.5,1,0 hydrogen:1,0,0,0 shell:2,3 gyroid:-1 gaussians:0 heat:1 hydro; do
  refuse 2 --field mesh cube.off -o x.vtu --field "$value"
done

# A signal ends both processes soon and leaves nothing: this surface would keep TetGen busy for long.
before=$(files)
for signal in INT:130 TERM:143 HUP:129; do
  checks=$((checks + 1))
  start=$(date +%s%N)
  timeout --foreground --preserve-status -k 20 -s "${signal%:*}" 1 "$tetcast" mesh cube.off -o long.vtu --quality 1.01 \
    --max-volume 1e-7 2>"$work.err"
  code=$?
  elapsed=$((($(date +%s%N) - start) / 1000000))
  [ "$code" = "${signal#*:}" ] || fail "exit code $code after ${signal%:*}"
  [ "$elapsed" -lt 4000 ] || fail "$elapsed ms until the end after ${signal%:*}"
  [ "$(cat "$work.err")" = 'tetcast: error: interrupted' ] || fail "standard error: $(cat "$work.err")"
  [ "$before" = "$(files)" ] || fail "files are left: $(files)"
done

rm -f "$work.err"

# Surfaces of other people's software.
data=$TETCAST_DATA/surfaces
if [ -d "$data" ]; then
  for name in bear.off femur.off turbine.off fandisk.off knot2.off example.poly; do
    accept mesh "$data/$name" -o data.vtu
    accept info data.vtu
    contains 'inverted cells +0'
  done
  refuse 1 'cow.off: the surface intersects itself: ' mesh "$data/cow.off" -o x.vtu
  refuse 1 'blade.off: the surface is open: 240 edges' mesh "$data/blade.off" -o x.vtu
  refuse 1 'pliers_binary.stl: the surface intersects itself' mesh "$data/pliers_binary.stl" -o x.vtu
else
  echo "without $data"
fi
finish
