# SPDX-License-Identifier: Apache-2.0
# tetcast cast: what rays of a list gather, the matrix of what they cross, what is refused.
. "$(dirname "$0")/lib.sh"
needs vtk
vtu cube.vtu "$five_tetrahedra" 10
vtu hexahedron.vtu '0 1 2 3 4 5 6 7' 12

# near FILE LINE COLUMN WANTED: a number of a .csv, to 14 digits.
near() {
  checks=$((checks + 1))
  awk -F, -v line="$2" -v column="$3" -v wanted="$4" 'NR == line {
    found = 1; off = $column - wanted; size = wanted < 0 ? -wanted : wanted
    if (off < 0) off = -off
    if (!(off <= 1e-14 * (size > 1 ? size : 1))) { print "line " NR ", column " column ": " $column " instead of " wanted; exit 1 }
  } END { if (!found) { print "there is no line " line; exit 1 } }' "$1" || fail "$1 ($2, $3)"
}

# Along an axis, twice as far per unit of t, a part of a ray, and one that passes by. The scalar s is linear in each cell.
cat >rays.csv <<END
ox,oy,oz,dx,dy,dz,begin,end
-1,0.3,0.4,1,0,0,0,inf
0.25,0.25,-3,0,0,2,-inf,inf
-1,0.3,0.4,1,0,0,1.25,1.75
5,5,5,1,0,0,0,inf
END
echo '{"color": [[0,1,0.5,0.25]], "extinction": [[0,3]]}' >gray.json
accept cast cube.vtu --array s --transfer gray.json --rays rays.csv -o out.csv --channels error,length
[ "$(head -n 1 out.csv)" = red,green,blue,alpha,optical_depth,length,error ] || fail "header: $(head -n 1 out.csv)"
[ "$(wc -l <out.csv)" = 5 ] || fail "rows: $(wc -l <out.csv)"
near out.csv 2 4 0.95021293163213605
near out.csv 2 2 0.47510646581606803
near out.csv 2 5 3
near out.csv 2 6 1
near out.csv 3 5 3
near out.csv 3 6 1
near out.csv 4 5 1.5
near out.csv 4 6 0.5
near out.csv 5 4 0
near out.csv 5 6 0
# However opaque matter is, its depth is known.
echo '{"color": [[0,1,0.5,0.25]], "extinction": [[0,3e5]]}' >wall.json
accept cast cube.vtu --array s --transfer wall.json --rays rays.csv -o wall.csv
near wall.csv 2 4 1
near wall.csv 2 5 300000
# Clipped, by any traversal and number of threads.
accept cast cube.vtu --array s --transfer gray.json --rays rays.csv -o clip.csv --clip 1,0,0,0.5
near clip.csv 2 5 1.5
near clip.csv 4 5 0.75
accept cast cube.vtu --array s --transfer gray.json --rays rays.csv -o other.csv --channels length,error --threads 1
same out.csv other.csv 'threads, order of channels'
accept cast cube.vtu --array s --transfer gray.json --rays rays.csv -o faces.csv --traversal faces
near faces.csv 2 5 3
# Values, surfaces, groups.
accept cast cube.vtu --array s --blend additive --rays rays.csv -o sum.csv
[ "$(head -n 1 sum.csv)" = red,green,blue,alpha,value ] || fail "header: $(head -n 1 sum.csv)"
near sum.csv 2 5 2.3
grep -q ',nan$' sum.csv || fail 'a ray that passes by has a value'
accept cast cube.vtu --array s --isosurface 2 --rays rays.csv -o surface.csv
near surface.csv 2 4 1
accept cast cube.vtu --extinction v --emission v --groups --rays rays.csv -o groups.csv
[ "$(head -n 1 groups.csv)" = "red,green,blue,alpha,optical_depth,radiance_0,optical_depth_0,transmittance_0,radiance_1,\
optical_depth_1,transmittance_1,radiance_2,optical_depth_2,transmittance_2" ] || fail "header: $(head -n 1 groups.csv)"
near groups.csv 2 5 0.4
near groups.csv 2 7 0.5
near groups.csv 2 8 0.60653065971263342
near groups.csv 2 6 0.39346934028736658
near groups.csv 2 13 0.4
near groups.csv 5 8 1
accept cast cube.vtu --extinction v:0 --rays rays.csv -o one.csv
[ "$(head -n 1 one.csv)" = red,green,blue,alpha,optical_depth,radiance_0,optical_depth_0,transmittance_0 ] || fail 'one group'

# A scene without its camera.
cat >scene.json <<END
{"input": "cube.vtu", "array": "s", "transfer": "gray.json", "size": [9, 9], "channels": "depth", "output": "a.exr",
 "camera": {"eye": [1, 2, 3]}}
END
accept cast --scene scene.json --rays rays.csv -o scene.csv --channels error,length
same out.csv scene.csv scene

# Columns in any order, blanks, lines of other systems.
printf 'dx, dy ,dz,OX,oy,oz\r\n1,0,0, -1 ,0.3,0.4\r\n\r\n0,0,2,0.25,0.25,-3\r\n' >mixed.csv
accept cast cube.vtu --array s --transfer gray.json --rays mixed.csv -o mixed-out.csv
near mixed-out.csv 2 5 3
near mixed-out.csv 3 5 3
# No rays: no rows.
echo ox,oy,oz,dx,dy,dz >none.csv
accept cast cube.vtu --array s --rays none.csv -o none-out.csv --matrix none.mtx
[ "$(cat none-out.csv)" = red,green,blue,alpha,optical_depth ] || fail "no rays: $(cat none-out.csv)"
grep -q '^0 8 0 *$' none.mtx || fail "no rays: $(cat none.mtx)"

# .npy: 6 columns of results are as good as rays of 6 numbers.
accept cast cube.vtu --array s --transfer gray.json --rays rays.csv -o out.npy --channels length
[ "$(head -c 6 out.npy | od -An -tx1 | tr -d ' ')" = 934e554d5059 ] || fail 'no .npy'
[ "$(wc -c <out.npy)" = $((128 + 4 * 6 * 8)) ] || fail "size of out.npy: $(wc -c <out.npy)"
head -c 127 out.npy | tail -c 117 | grep -qF "{'descr': '<f8', 'fortran_order': False, 'shape': (4, 6), }" || fail 'header of out.npy'
[ "$(tail -c +129 out.npy | od -An -v -tf8 -w48 | awk 'NR == 3 { printf "%.12g %.12g", $5, $6 }')" = '1.5 0.5' ] ||
  fail "numbers: $(tail -c +129 out.npy | od -An -v -tf8 -w48)"
head -c $((128 + 3 * 48)) out.npy | sed "1s/(4, 6)/(3, 6)/" >three.npy # without the ray that passes by, and has no direction
accept cast cube.vtu --array s --rays three.npy -o by-npy.csv
{ echo ox,oy,oz,dx,dy,dz && sed -n '2,4p' out.csv | cut -d, -f1-6; } >three.csv
accept cast cube.vtu --array s --rays three.csv -o by-csv.csv
same by-npy.csv by-csv.csv '.npy and .csv'
refuse 1 'out.npy: row 3: the direction is 0, 0, 0' cast cube.vtu --array s --rays out.npy -o a.csv

# The matrix: rows times values are line integrals, sums of rows are lengths.
accept cast hexahedron.vtu --array 'c d' --rays rays.csv --matrix cells.mtx
[ "$(head -n 1 cells.mtx)" = '%%MatrixMarket matrix coordinate real general' ] || fail 'head of cells.mtx'
sed -n '3p' cells.mtx | grep -q '^4 1 3 *$' || fail "sizes of cells.mtx: $(sed -n 3p cells.mtx)"
accept cast cube.vtu --array s --rays rays.csv --matrix points.mtx -o both.csv
accept cast cube.vtu --array s --rays rays.csv --matrix five.mtx --basis cells
sed -n '3p' five.mtx | grep -q '^4 5 ' || fail "sizes of five.mtx: $(sed -n 3p five.mtx)"
# sums FILE VALUES…: for each row of the matrix, its sum and its product with the values.
sums() {
  local file=$1
  shift
  awk -v values="$*" 'BEGIN { split(values, value, " ") } NR > 3 { sum[$1] += $3; product[$1] += $3 * value[$2]; last = NR }
    NR == 3 { entries = $3 } END {
      if (last - 3 != entries) print entries " entries announced, there are " last - 3
      for (i = 1; i <= 4; i++) printf "%d:%.12g,%.12g ", i, sum[i], product[i]
    }' "$file"
}
checks=$((checks + 3))
[ "$(sums cells.mtx 0.5)" = '1:1,0.5 2:1,0.5 3:0.5,0.25 4:0,0 ' ] || fail "cells.mtx: $(sums cells.mtx 0.5)"
[ "$(sums points.mtx 0 1 3 2 3 4 6 5)" = '1:1,2.3 2:1,2.25 3:0.5,1.15 4:0,0 ' ] || fail "points.mtx: $(sums points.mtx 0 1 3 2 3 4 6 5)"
[ "$(sums five.mtx 1 1 1 1 1)" = '1:1,1 2:1,1 3:0.5,0.5 4:0,0 ' ] || fail "five.mtx: $(sums five.mtx 1 1 1 1 1)"

# What is wrong with rays: one line that says where.
wrong() { # wrong TEXT LINES
  printf "$2" >bad.csv
  refuse 1 "$1" cast cube.vtu --array s --rays bad.csv -o a.csv
  rm bad.csv
}
names='ox,oy,oz,dx,dy,dz'
wrong 'bad.csv: is empty' ''
wrong 'bad.csv:1: the column dz is missing' 'ox,oy,oz,dx,dy\n0,0,0,1,0\n'
wrong "bad.csv:1: unknown column 'x'" 'x,oy,oz,dx,dy,dz\n'
wrong "bad.csv:1: a second column 'ox'" "ox,$names\n"
wrong 'bad.csv:3: 5 numbers instead of 6' "$names\n0,0,0,1,0,0\n0,0,0,1,0\n"
wrong 'bad.csv:2: more numbers' "$names\n0,0,0,1,0,0,0\n"
wrong "bad.csv:2: dx is 'nan', not a number" "$names\n0,0,0,nan,0,0\n"
wrong "bad.csv:2: oy is 'inf', not a number" "$names\n0,inf,0,1,0,0\n"
wrong "bad.csv:3: oz is '', not a number" "$names\n0,0,0,1,0,0\n0,0,,1,0,0\n"
wrong 'bad.csv:2: the direction is 0, 0, 0' "$names\n0,0,0,0,0,0\n"
wrong 'bad.csv:2: it begins after its end' "$names,begin,end\n0,0,0,1,0,0,2,1\n"
npy() { # npy TYPE ORDER SHAPE: without numbers
  local header="{'descr': '$1', 'fortran_order': $2, 'shape': $3, }"
  printf "\x93NUMPY\x01\x00\x76\x00%-117s\n" "$header" >bad.npy
  shift 3
}
bad_npy() {
  npy "$2" "$3" "$4"
  refuse 1 "$1" cast cube.vtu --array s --rays bad.npy -o a.csv
  rm bad.npy
}
bad_npy "expected float64" '<f4' False '(3, 6)'
bad_npy "Fortran" '<f8' True '(3, 6)'
bad_npy "expected (n, 6) or (n, 8)" '<f8' False '(3, 7)'
bad_npy "expected (n, 6) or (n, 8)" '<f8' False '(18,)'
bad_npy "is truncated" '<f8' False '(3, 6)'
npy '<f8' False '(0, 8)'
accept cast cube.vtu --array s --rays bad.npy -o none.npy
[ "$(wc -c <none.npy)" = 128 ] || fail 'no rays as .npy'
head -c 40 out.npy >bad.npy
refuse 1 'damaged' cast cube.vtu --array s --rays bad.npy -o a.csv
printf '\x93NUMPY\x02' >bad.npy
refuse 1 'another version' cast cube.vtu --array s --rays bad.npy -o a.csv
refuse 1 'cannot read' cast cube.vtu --array s --rays nowhere.csv -o a.csv
refuse 1 'cannot read' cast cube.vtu --array s --rays . -o a.csv

# What is wrong with the command line.
refuse 2 'no input' cast --rays rays.csv -o a.csv
refuse 2 'no rays' cast cube.vtu -o a.csv
refuse 2 'no output' cast cube.vtu --rays rays.csv
refuse 2 '.csv or .npy' cast cube.vtu --rays rays.csv -o a.txt
refuse 2 '--basis: needs --matrix' cast cube.vtu --rays rays.csv -o a.csv --basis cells
refuse 2 'expected cells or points' cast cube.vtu --rays rays.csv --matrix a.mtx --basis faces
refuse 2 'not possible with --clip' cast cube.vtu --rays rays.csv --matrix a.mtx --clip 1,0,0,0
refuse 2 'single step' cast cube.vtu --rays rays.csv -o a.csv --time all
refuse 2 'seen from a camera' cast cube.vtu --rays rays.csv -o a.csv --shade volume --array s --transfer gray.json
refuse 2 'length, error, or both' cast cube.vtu --rays rays.csv -o a.csv --channels depth
refuse 2 'about one step' cast a_1.vtu a_2.vtu --rays rays.csv -o a.csv
refuse 2 'would replace --rays' cast cube.vtu --rays rays.csv -o rays.csv
refuse 2 'the same file' cast cube.vtu --rays rays.csv -o a.csv --matrix a.csv
for option in '--size 9x9' '--eye 1,2,3' '--samples 4' '--fovy 30' '--background white' '--pixel-type float' --outline \
  '--integrator exact' '--tolerance 0.1' --deep '--save-scene a.json' '--stats a.json' '--repeat 2'; do
  # shellcheck disable=SC2086  # a list of words
  refuse 2 "${option%% *} is about pictures" cast cube.vtu --rays rays.csv -o a.csv $option
done
refuse 2 '--rays' render cube.vtu --rays rays.csv
refuse 1 'its folder does not exist' cast cube.vtu --rays rays.csv -o nowhere/a.csv
refuse 1 "no array 'x'" cast cube.vtu --array x --rays rays.csv -o a.csv
finish
