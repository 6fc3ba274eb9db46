# SPDX-License-Identifier: Apache-2.0
# tetcast render --extinction, --emission, --groups: pictures, channels, scenes, what is refused.
. "$(dirname "$0")/lib.sh"
needs vtk openimageio
vtu cube.vtu "$five_tetrahedra" 10
scalar='0 1 3 -2 3 4 6 5' vtu negative.vtu "$five_tetrahedra" 10
scalar='0 1 nan 2 nan 4 6 5' vtu nan.vtu "$five_tetrahedra" 10

# With an emission of as much as the extinction, the radiance is the opacity: the picture of white dust.
echo '{"color": [[0,1,1,1]], "extinction": [[0,0],[6,6]]}' >white.json
accept render cube.vtu -o white.png --array s --transfer white.json --size 61x47 --bare --pixel-type uint16 --background 0,0,0
accept render cube.vtu -o dust.png --extinction s --emission s --size 61x47 --pixel-type uint16
same dust.png white.png 'emission as extinction'
accept render cube.vtu -o faces.png --extinction s --emission s --size 61x47 --pixel-type uint16 --traversal faces --threads 1
same faces.png white.png traversal
# Without emission, what comes through of the white behind.
accept render cube.vtu -o shadow.png --extinction s --size 61x47 --pixel-type uint16
echo '{"color": [[0,0,0,0]], "extinction": [[0,0],[6,6]]}' >black.json
accept render cube.vtu -o black.png --array s --transfer black.json --bare --background white --size 61x47 --pixel-type uint16
same shadow.png black.png 'radiograph'
# Cells, components, colour.
accept render cube.vtu -o cells.png --extinction 'c d' --size 61x47
differ cells.png shadow.png cells
accept render cube.vtu -o red.exr --extinction s --emission v:0 --size 61x47
accept render cube.vtu -o color.exr --extinction s --emission v --size 61x47
differ red.exr color.exr colour
warn 'above 1 all is white' render cube.vtu -o bright.png --emission s --size 30x20
refuse 1 'above 1 all is white' render cube.vtu -o strict.png --emission s --size 30x20 --strict
accept render cube.vtu -o bright.png --emission s --size 30x20 --quiet
accept render cube.vtu -o bright.exr --emission s --size 30x20

# Channels by name.
has() {
  local file=$1 name
  shift
  checks=$((checks + 1))
  for name; do head -c 2000 "$file" | grep -qaF "$name" || fail "no channel '$name' in $file"; done
}
accept render cube.vtu -o channels.exr --extinction s --emission v:1 --size 30x20 \
  --channels radiance,optical_depth,transmittance,path_length --stats stats.json
has channels.exr radiance optical_depth transmittance path_length
grep -q '"error": null' stats.json || fail "error: $(cat stats.json)"
# By the same instructions as other pictures.
accept render cube.vtu -o usual.exr --array s --size 30x20 --stats usual.json
isa=$(grep '"isa": ' stats.json)
[ -n "$isa" ] && [ "$isa" = "$(grep '"isa": ' usual.json)" ] || fail "isa: $(cat stats.json usual.json)"
accept render cube.vtu -o scalar.exr --extinction s --emission v:1 --size 30x20 --isa scalar --stats scalar.json
grep -q '"isa": "scalar"' scalar.json || fail "isa: $(cat scalar.json)"
accept render cube.vtu -o groups.exr --extinction s --emission v --groups --size 30x20
has groups.exr radiance.0 radiance.1 radiance.2
accept render cube.vtu -o radiograph.exr --extinction v --groups --size 30x20
has radiograph.exr transmittance.0 transmittance.1 transmittance.2
accept render cube.vtu -o depth.tif --extinction v --groups --channels optical_depth --size 30x20 --pixel-type double
accept render cube.vtu -o depth2.tif --extinction v --groups --channels optical_depth --size 30x20 --pixel-type double --threads 1
same depth.tif depth2.tif threads
[ "$(wc -c <depth.tif)" -lt $((30 * 20 * 3 * 8 + 4000)) ] || fail "depth.tif has more than three channels: $(wc -c <depth.tif)"

# A scene keeps it all.
accept render cube.vtu -o one.exr --extinction v --emission v --groups --channels radiance,path_length --size 30x20 \
  --eye 3,2,4 --save-scene scene.json
accept render --scene scene.json -o two.exr
same one.exr two.exr scene
accept render --scene scene.json -o three.exr --emission s
differ one.exr three.exr 'the option wins'
accept render cube.vtu -o glow.png --emission v:0 --size 30x20 --save-scene glow.json
accept render --scene glow.json -o glow2.png
same glow.png glow2.png 'background of a scene'
accept render --scene glow.json -o other.png --array s
accept render cube.vtu -o plain.png --array s --size 30x20 --bare --background 0,0,0 --save-scene plain.json
same other.png plain.png 'an array wins over a scene of coefficients'
accept render --scene plain.json -o glow3.png --emission v:0
same glow.png glow3.png 'coefficients win over a scene of an array'
refuse 1 'nothing to compare' converge --scene scene.json -o report
refuse 1 'quiet: expected true or false' render --scene <(echo '{"input": "cube.vtu", "quiet": 1}')
echo '{"input": "cube.vtu", "emission": "s", "groups": 1}' >bad.json
refuse 1 'groups: expected true or false' render --scene bad.json
echo '{"input": "cube.vtu", "emission": "s", "array": "s"}' >bad.json
refuse 1 'exclude each other' render --scene bad.json

# A series, and cells made points.
cat >series.pvd <<END
<?xml version="1.0"?>
<VTKFile type="Collection" version="0.1"><Collection>
<DataSet timestep="0" file="cube.vtu"/><DataSet timestep="0.5" file="nan.vtu"/><DataSet timestep="1" file="cube.vtu"/>
</Collection></VTKFile>
END
warn 'array s: 2 values' render series.pvd -o 'series%d.png' --extinction s --emission s --size 61x47 --pixel-type uint16
same series0.png dust.png 'first step'
same series2.png dust.png 'last step'
differ series1.png dust.png 'step between'
accept render cube.vtu -o points.png --extinction 'c d' --size 61x47 --cell-to-point
differ points.png cells.png --cell-to-point

# What is wrong.
refuse 1 "no array 'kappa'" render cube.vtu -o a.png --extinction kappa
refuse 1 "no array 'kappa'" render cube.vtu -o a.exr --extinction kappa --groups
refuse 1 "no component '3'" render cube.vtu -o a.png --emission v:3
refuse 1 "--extinction: array 'v' has 3 components" render cube.vtu -o a.png --extinction v --emission v
refuse 1 'array s: a negative extinction, -2 at vertex 3' render negative.vtu -o a.png --extinction s
accept render negative.vtu -o a.exr --emission s --size 9x9
warn 'array s: 2 values are NaN or infinite' render nan.vtu -o a.exr --extinction s --size 9x9
for other in '--array s' '--preset inferno' '--range 0,1' '--transfer white.json' '--opacity-model ospray'; do
  refuse 2 'exclude each other' render cube.vtu -o a.png --emission s ${other%% *} ${other#* }
  refuse 2 'exclude each other' render cube.vtu -o a.png ${other%% *} ${other#* } --extinction s
done
refuse 2 'there is only exact' render cube.vtu -o a.png --emission s --integrator midpoint:4
accept render cube.vtu -o a.exr --emission s --integrator exact --tolerance 1e-3 --size 9x9
accept render cube.vtu -o a.exr --emission s --channels error,radiance --size 9x9
refuse 2 'without --extinction or --emission' render cube.vtu -o a.exr --channels radiance
refuse 2 'without --extinction or --emission' render cube.vtu -o a.exr --channels path_length,error
refuse 2 'needs --emission' render cube.vtu -o a.exr --extinction s --channels radiance
refuse 2 'need --extinction' render cube.vtu -o a.exr --emission s --channels transmittance
refuse 2 'needs --extinction or --emission' render cube.vtu -o a.exr --groups
refuse 2 '--groups: only .exr and .tif' render cube.vtu -o a.png --emission v --groups
refuse 2 '--groups: needs floating-point pixels' render cube.vtu -o a.tif --emission v --groups --pixel-type uint8
refuse 2 'expected error' render cube.vtu -o a.exr --emission s --channels radiance,radiance
finish
