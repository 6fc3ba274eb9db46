# SPDX-License-Identifier: Apache-2.0
# What is wrong with a command line is said before anything is read, with exit code 2.
. "$(dirname "$0")/lib.sh"

accept --version
contains '^tetcast [0-9]+\.[0-9]+\.[0-9]+'
contains 'Embree [34]\.'
contains 'adapters:'
accept --help
contains 'render'
for command in render converge transfer cast info mesh; do
  accept $command --help
  contains "Usage: tetcast $command"
  contains 'Example'
  [ "$(echo "$output" | wc -l)" -le 40 ] || fail "help of $command does not fit a screen"
  [ "$(echo "$output" | wc -L)" -le 120 ] || fail "help of $command is too wide"
done
accept render -h
accept -V
contains '^tetcast [0-9]'
accept help
contains 'Usage: tetcast COMMAND'
for command in render converge transfer cast info mesh completion; do
  accept help $command
  contains "Usage: tetcast $command"
done

# Quick: no adapter's library is loaded.
LD_DEBUG=files "$tetcast" --version >/dev/null 2>"$work.err"
grep -q 'file=libtetcast' "$work.err" || fail 'the loader says nothing of libtetcast'
if grep -qE 'file=(libvtk|libOpenImageIO|libtet\.|libtetcast-)' "$work.err"; then
  fail "--version loads $(grep -oE 'file=(libvtk|libOpenImageIO|libtet\.|libtetcast-)[^ ]*' "$work.err" | sort -u | head -3 | xargs)"
fi

refuse 2 'no command given: render, converge, transfer, cast, info or mesh'
refuse 2 "unknown command 'rendre'; did you mean 'render'?" rendre x.vtu
refuse 2 "unknown command 'rendre'; did you mean 'render'?" help rendre
refuse 2 "unknown command 'x.vtu' (see" x.vtu
touch x.vtu
refuse 2 "did you mean tetcast render x.vtu?" x.vtu
rm x.vtu
refuse 2 "unknown option '--vers'" --vers
refuse 2 'no input' render
refuse 2 'no input' info
refuse 2 'more than one input' render a.vtu b.vtu
refuse 2 'a file that lists them (.pvtu, .vtm or .pvd)' render a.vtu b.vtu
refuse 2 'numbered' render a_1.vtu b_2.vtu
refuse 2 'numbered' render a_1.vtu a_2.vtk
refuse 2 'numbered' render a_1.vtu a_1.vtu
refuse 2 'about one step' converge a_1.vtu a_2.vtu -o r
refuse 2 'only numbers, from 0' render a_1.vtu a_2.vtu --time t=1
refuse 2 'more than one input' info a.vtu b.vtu
refuse 2 '--bogus' render a.vtu --bogus
refuse 2 '--bogus (see' info a.vtu --bogus # nothing is near

# What was meant.
refuse 2 '--presett; did you mean --preset?' render a.vtu --presett viridis
refuse 2 '--outptu; did you mean --output?' render a.vtu --outptu=a.png
refuse 2 '--trehads; did you mean --threads?' converge a.vtu -o r --trehads 2
refuse 2 '--jsno; did you mean --json?' info a.vtu --jsno
refuse 2 '--feild; did you mean --field?' mesh a.off -o a.vtu --feild heat
refuse 2 '-size; did you mean --size?' render a.vtu -size 9x9
refuse 2 '-output; did you mean --output?' render a.vtu -output a.png
refuse 2 "did you mean 'viridis'?" render a.vtu --preset virdis
refuse 2 "did you mean 'gyroid'?" mesh a.off -o a.vtu --field gyriod
refuse 2 "did you mean 'black'?" render a.vtu --background blak
for text in 'tolerance: 0.1' '"size": [9,9]' ' '; do # is no scene, and no mesh
  echo "{$text}" >x.json
  refuse 1 x.json render x.json
done
echo ' {"input": "a.vtu", "output": "a.png"}' >scene.json
echo '{"color": [[0,1,1,1]], "extinction": [[0,1]]}' >transfer.json
for command in render 'converge -o r' info; do
  # shellcheck disable=SC2086  # a list of words
  refuse 2 "'scene.json' is a scene, not a mesh: render takes it by --scene scene.json" $command scene.json
  # shellcheck disable=SC2086
  refuse 2 "'transfer.json' is a transfer function, not a mesh: render takes it by --transfer transfer.json" $command transfer.json
done
rm ./*.json
refuse 2 'option -x' render a.vtu -x
refuse 2 '--json takes no argument' info a.vtu --json=1
refuse 2 '-o needs an argument' render a.vtu -o
refuse 2 '--size needs an argument' render a.vtu --size
for size in 0x10 10x0 -5x5 10 10x 10x10x10 1.5x2 x 4e9x1 2000000x1 1048576x1048576 '10 x10' 10x10a; do
  refuse 2 "--size $size: expected WxH" render a.vtu --size "$size"
done
for number in '' 1,2 1,2,3,4 1,,3 1,2,x nan,0,0 inf,0,0 1e999,0,0 0x1,0,0 ' 1,2,3' '1,2,3 ' 1,2,3, --; do
  refuse 2 "expected three numbers" render a.vtu --eye "$number"
done
refuse 2 'not all zero' render a.vtu --up 0,0,0
for angle in 0 180 -5 360 x; do refuse 2 'angle' render a.vtu --fovy "$angle"; done
for height in 0 -1 inf; do refuse 2 'height' render a.vtu --ortho "$height"; done
for samples in 0 -1 1.5 65537 x; do refuse 2 'whole number' render a.vtu --samples "$samples"; done
for threads in -1 1.5 5000 x; do refuse 2 'whole number' render a.vtu --threads "$threads"; done
for repeat in 0 -1 x; do refuse 2 'whole number' render a.vtu --repeat "$repeat"; done
for background in 1,1 1,1,1,1,1 2,0,0 -1,0,0 255,255,255 snow '' '#' '#12' '#12345' '#1234567' '#ggg' '#fff '; do refuse 2 'r,g,b' render a.vtu --background "$background"; done
for range in 1 3,1 1,2,3 a,b; do refuse 2 'LO not above HI' render a.vtu --range "$range"; done
refuse 2 'viridis' render a.vtu --preset nope
refuse 2 'uint8' render a.vtu --pixel-type int8
refuse 2 'uint8' render a.vtu --pixel-type ''
refuse 2 'shell or faces' render a.vtu --traversal walk
refuse 2 'avx512' render a.vtu --isa sse9
refuse 2 'vtk-unstructured' render a.vtu --opacity-model vtk
for integrator in exact:2 midpoint midpoint: midpoint:0 midpoint:1.5 gauss:17 table:1 table:x simpson:3; do
  refuse 2 'gauss:N' render a.vtu --integrator "$integrator"
done
for tolerance in -1 x inf 1,2 ''; do refuse 2 '0 or above' render a.vtu --tolerance "$tolerance"; done
for channels in dept '' error,error error,dept ,error; do
  refuse 2 'expected error' render a.vtu -o a.exr --channels "$channels"
done
refuse 2 'not the default, a .png' render a.vtu --channels error
for name in a.png a.jpg a.hdr error; do refuse 2 "not $name" render a.vtu -o $name --channels error; done
for type in uint8 uint16; do
  refuse 2 "floating-point pixels, not $type" render a.vtu -o a.tif --channels error --pixel-type $type
done
refuse 2 'only the exact integrator' render a.vtu -o a.exr --channels error --integrator midpoint:1
refuse 2 'only the exact integrator' render a.vtu --tolerance 1e-3 --integrator gauss:3
refuse 2 'exclude each other' render a.vtu --fovy 30 --ortho 1
refuse 2 'exclude each other' render a.vtu --transfer t.json --preset viridis
refuse 2 'exclude each other' render a.vtu --range 0,1 --transfer t.json
refuse 2 'same point' render a.vtu --eye 1,2,3 --target 1,2,3
refuse 2 'parallel' render a.vtu --eye 0,0,5 --target 0,0,0 --up 0,0,1
finish
