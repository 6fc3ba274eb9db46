# SPDX-License-Identifier: Apache-2.0
# Colour maps: those that there are, and those of ParaView's files.
. "$(dirname "$0")/lib.sh"

# Names, their kinds and reverses.
accept render --preset list
contains '^viridis +sequential$'
contains '^RdBu +diverging$'
contains '^okabe-ito +categorical$'
for name in $(sed 's/ .*//' <<<"$output"); do
  refuse 2 'no input' render --preset "$name"
  refuse 2 'no input' render --preset "${name}_r"
done
refuse 2 "did you mean 'cividis'?" render a.vtu --preset cividiss
refuse 2 'no such preset' render a.vtu --preset viridis_rr
refuse 2 'no such preset' render a.vtu --preset list_r
refuse 2 'no such preset' converge a.vtu -o report --preset list
needs vtk openimageio
accept render --preset list -o list.png
accept render --preset list -o list.ppm
exists list.png list.ppm
[ -z "$output" ] || fail "names and a picture: $output"
refuse 1 'its folder does not exist' render --preset list -o nowhere/list.png
refuse 1 "format '.xyz'" render --preset list -o list.xyz

vtu cube.vtu "$five_tetrahedra" 10
small='--size 32x24 --eye 3,2,4'
# shown NAME PRESET [OPTION…]: NAME.png and NAME.json, the transfer function in $output.
shown() {
  local name=$1 preset=$2
  shift 2
  accept render cube.vtu --array s $small --preset "$preset" "$@" -o "$name.png" --save-scene "$name.json"
  output=$(tr -d ' \n' <"$name.json" | sed 's/.*"color":\(\[\[.*\]\]\),"extinction":\(\[\[[^"]*\]\]\).*/\1 \2/')
}
shown magma magma
magma_knots=$(tr -cd '[' <<<"$output" | wc -c)
shown reverse magma_r
[ "$(tr -cd '[' <<<"$output" | wc -c)" = "$magma_knots" ] || fail 'a reverse has other knots'
differ magma.png reverse.png
shown steps okabe-ito --range 0,8
contains '^\[\[0.0,0.90[0-9]*,0.62[0-9]*,0.0\],\[1.0,0.90[0-9]*,0.62[0-9]*,0.0\],\[1.0,0.33'

# A file of several maps: the first, or the one that is named, here in JSON and in XML, with any values of x.
cat >maps.json <<'END'
[{"ColorSpace": "RGB", "Name": "fire: red", "NanColor": [1, 1, 0], "RGBPoints": [-2, 0, 0, 0, 0, 1, 0, 0, 2, 1, 1, 0.5]},
 {"ColorSpace": "Diverging", "Name": "two", "RGBPoints": [0, 0.25, 0.5, 1, 1, 1, 0.25, 0]},
 {"Name": "kinds", "IndexedColors": [1, 0, 0, 0, 0, 1], "Annotations": [0, "a", 1, "b"]},
 {"ColorSpace": "Step", "Name": "steps", "RGBPoints": [0, 1, 1, 1, 1, 1, 0, 0, 2, 0, 0, 1]},
 {"ColorSpace": "RGB", "Name": "ramp", "RGBPoints": [0, 0, 0, 0, 4, 1, 1, 1], "Points": [0, 0, 0.5, 0, 4, 0.5, 0.5, 0]},
 {"ColorSpace": "RGB", "Name": "peak", "RGBPoints": [2, 0, 0, 0, 6, 1, 1, 1],
  "Points": [2, 0, 0.5, 0, 4, 1, 0.25, 0.5, 5, 0.5, 0.5, 1, 6, 0, 0.5, 0]},
 {"ColorSpace": "Rainbow", "Name": "bad", "RGBPoints": [0, 0, 0, 0, 4, 1, 1, 1]},
 {"Name": "shadow", "ColorSpace": "RGB", "RGBPoints": [0, 0, 0, 0, 4, 1, 1, 1]}]
END
cat >maps.XML <<'END'
<?xml version="1.0"?>
<!-- made by hand -->
<ColorMaps>
  <ColorMap name="fire: red" space="RGB">
    <Point x="0" o="1" r="0" g="0" b="0"/> <Point x="4" o="1" r="1" g="0" b="0"/> <Point x="8" o="1" r="1" g="1" b="0.5"/>
    <NaN r="1" g="1" b="0"/>
  </ColorMap>
  <ColorMap name="two" space="Diverging"><Point x="0" r="0.25" g="0.5" b="1"/><Point x="1" r="1" g="0.25" b="0"/></ColorMap>
  <ColorMap name="kinds" indexedLookup="true"><Point x="0" r="1" g="0" b="0"/><Point x="1" r="0" g="0" b="1"/></ColorMap>
  <ColorMap name="half" space="RGB"><Point x="0" o="0" r="0" g="0" b="0"/><Point x="1" o=".5" r="1" g="1" b="1"/></ColorMap>
  <ColorMap name="wrapped" space="Wrapped"><Point x="0" r="1" g="0" b="0"/><Point x="1" r="0" g="0" b="1"/></ColorMap>
  <ColorMap name="hsv" space="HSV"><Point x="0" r="1" g="0" b="0"/><Point x="1" r="0" g="0" b="1"/></ColorMap>
</ColorMaps>
END
"$tetcast" render cube.vtu --array s $small --preset maps.json -o first.png 2>said
checks=$((checks + 1))
grep -q "note: maps.json has 8 colour maps and the first is taken, 'fire: red'; .*: two, kinds, steps, ramp, peak, bad, shadow" said ||
  fail "no note of the other maps: $(cat said)"
shown fire 'maps.json:fire: red' --range 0,4
[ "$output" = "${output/\[2.0,1.0,0.0,0.0\]/}" ] && fail "the middle point is not in the middle: $output"
shown fire_xml 'maps.XML:fire: red' --range 0,4
same fire.png fire_xml.png
shown first maps.XML
shown first_json maps.json
same first.png first_json.png
shown two maps.json:two
[ "$(tr -cd '[' <<<"$output" | wc -c)" -gt 12 ] || fail "no white between: $output"
shown two_xml maps.XML:two
same two.png two_xml.png
shown kinds maps.json:kinds --range 0,4
contains '^\[\[0.0,1.0,0.0,0.0\],\[2.0,1.0,0.0,0.0\],\[2.0,0.0,0.0,1.0\],\[4.0,0.0,0.0,1.0\]\] '
shown kinds_xml maps.XML:kinds --range 0,4
same kinds.png kinds_xml.png
shown steps maps.json:steps --range 0,4
contains '^\[\[0.0,1.0,1.0,1.0\],\[0.0,1.0,0.0,0.0\],\[2.0,1.0,0.0,0.0\],\[2.0,0.0,0.0,1.0\],\[4.0,0.0,0.0,1.0\]\] '
shown wrapped maps.XML:wrapped
shown hsv maps.XML:hsv
differ wrapped.png hsv.png

# Opacities: of a ramp as without any, whatever its height; of a peak as linear pieces with steps where it has them.
shown shadow maps.json:shadow
shown ramp maps.json:ramp
same ramp.png shadow.png 'a ramp of opacity'
shown half maps.XML:half
same half.png shadow.png
refuse 1 "states opacities at places of its own" render cube.vtu --array s --preset maps.json:peak --log -o no.png
refuse 1 "states opacities at places of its own" render cube.vtu --array s --preset maps.json:peak --centre 1 -o no.png
shown peak maps.json:peak --range 0,4
contains ' \[\[0.0,0.0\],\[2.0,[0-9.]*\],.*\[3.5,[0-9.]*\],\[3.5,0.0\],\[4.0,0.0\]\]$'
differ peak.png shadow.png

# All that a preset is for: a surface's colour, whose scene names the file from its own folder, values along rays, labels,
# reports.
mkdir sub
accept render cube.vtu --array s $small --isosurface 2.5 --preset 'maps.json:fire: red' -o iso.png --save-scene sub/iso.json
tr -d ' \n' <sub/iso.json | grep -q '"preset":"../maps.json:fire:red"' || fail "$(grep preset sub/iso.json)"
accept render --scene sub/iso.json -o again.png
same iso.png again.png
accept render cube.vtu --array s $small --blend maximum --preset maps.json:two -o maximum.png
accept render cube.vtu --array s $small --blend additive --preset maps.json:two -o additive.png
vtu labels.vtu "$five_tetrahedra" 10
sed -i '/Name="\(s\|v\|flat\|c d\)"/d; s|<CellData>|&<DataArray type="Int32" Name="material" format="ascii">7 7 3 120 7</DataArray>|' labels.vtu
warn 'in the colours of' render labels.vtu $small --preset maps.json:two -o labels.png
accept converge cube.vtu --array s --preset maps.json:two -o report --size 9x9 --repeat 1 --no-plots
refuse 2 'exclude each other' render cube.vtu --transfer t.json --preset maps.json
refuse 2 'would replace --preset' render cube.vtu --preset maps.json:two --stats maps.json
warn '--opacity-model has no effect' render cube.vtu --array s $small --preset maps.json:two --opacity-model ospray -o x.png

# Files that are something else, or damaged.
bad() { refuse 1 "$2" render cube.vtu --array s -o y.png --preset "$1"; }
# json TEXT WHAT: a map with this text in place of its points.
json() {
  echo "[{\"Name\": \"m\", \"ColorSpace\": \"RGB\", $1}]" >b.json
  bad b.json "b.json: 'm': $2"
}
# xml TEXT WHAT
xml() {
  echo "$1" >b.xml
  bad b.xml "b.xml: $2"
}
fine='"RGBPoints": [0,0,0,0, 1,1,1,1]'
bad nowhere.json "cannot open 'nowhere.json'"
bad nowhere.xml 'nowhere.xml'
mkdir folder.json
bad folder.json 'folder.json'
bad maps.json:twoo "there is no colour map 'twoo' in it, there are fire: red, two, kinds, steps, ramp, peak, bad, shadow; did you mean 'two'?"
bad maps.json: "no colour map ''"
bad maps.XML:three 'no colour map'
bad maps.json:bad "ColorSpace 'Rainbow'"
: >empty.json
cp empty.json empty.xml
bad empty.json 'empty.json:1: '
bad empty.xml 'empty.xml: '
head -c 300 maps.json >cut.json
head -c 300 maps.XML >cut.xml
bad cut.json 'cut.json:3: '
bad cut.xml 'cut.xml: truncated or damaged'
bad peak.json "peak.json: map 0: is no colour map of ParaView's"
echo '{"color": [[0, 1, 1, 1]], "extinction": [[0, 1]]}' >b.json
bad b.json 'a transfer function is for --transfer'
for text in '[]' '[1]' '[[]]' '[{"Name": "m"}, 5]'; do
  echo "$text" >b.json
  bad b.json "b.json: expected ParaView's colour maps"
done
json '"a": 1' "is no colour map of ParaView's: expected \"RGBPoints\""
json '"RGBPoints": 5' 'RGBPoints: expected a list of numbers'
json '"RGBPoints": []' 'RGBPoints: expected a list of numbers'
json '"RGBPoints": [0,0,0,0, 1,1,1]' 'RGBPoints: expected a list of numbers: x, red, green, blue of each point'
json '"RGBPoints": [0,0,0,0]' 'RGBPoints: a single point'
json '"RGBPoints": [2,0,0,0, 2,1,1,1]' 'RGBPoints: all points are at 2'
json '"RGBPoints": [0,0,0,0, 2,1,1,1, 1,1,1,1]' 'RGBPoints: not sorted: point 2 at 1 comes after 2'
json '"RGBPoints": [0,0,0,0, 1,1,1,1, 1,1,1,1, 1,1,1,1, 2,1,1,1]' 'RGBPoints: more than two points at 1'
json '"RGBPoints": [0,0,0,0, "NaN",1,1,1]' 'RGBPoints: point 1: x: expected a number'
json '"RGBPoints": [0,0,0,0, 1,255,1,1]' 'RGBPoints: point 1: red is 255, expected a number from 0 to 1; is it from 0 to 255?'
json '"IndexedColors": [1, 1]' 'IndexedColors: expected a list of numbers: red, green, blue'
json '"IndexedColors": [1, 1, -1]' 'IndexedColors: point 0: blue is -1'
json "$fine, \"Points\": [0, 0, 0.5]" 'Points: expected a list of numbers'
json "$fine, \"Points\": [0, 0, 0.5, 0]" 'Points: a single point'
json "$fine, \"Points\": [0, 0, 0.5, 0, 1, 1.5, 0.5, 0]" 'Points: point 1: opacity is 1.5'
json "$fine, \"Points\": [0, 0, 2, 0, 1, 1, 0.5, 0]" 'Points: point 0: midpoint is 2'
json "$fine, \"Points\": [0, 0, 0.5, 0, -1, 1, 0.5, 0]" 'Points: not sorted'
echo '[{"Name": "m", "RGBPoints": [NaN, 0, 0, 0, 1, 1, 1, 1]}]' >b.json
bad b.json 'b.json:1: '
xml '<ParaView><ServerManagerState/></ParaView>' "expected ParaView's colour maps, <ColorMaps> or <ColorMap>, not <ParaView>"
xml '<ColorMaps></ColorMaps>' 'has no <ColorMap>'
xml '<ColorMap name="m"></ColorMap>' "'m': RGBPoints: expected a list"
xml '<ColorMap name="m"><Point x="0" r="0" g="0" b="0"/></ColorMap>' "'m': RGBPoints: a single point"
xml '<ColorMap name="m"><Point x="0" r="0" g="0" b="0"/><Point x="nan" r="0" g="0" b="0"/></ColorMap>' "'m': point 1: x=\"nan\""
xml '<ColorMap name="m"><Point x="0" r="0" g="0"/></ColorMap>' "'m': point 0: b=\"\": expected a number"
xml '<ColorMap name="m"><Point x="0" r="0" g="0" b="0"></ColorMap>' 'truncated or damaged'
echo '{"input": "cube.vtu", "array": "s", "preset": "nowhere.json:x"}' >s.json
refuse 1 'nowhere.json' render --scene s.json -o y.png
echo '{"input": "cube.vtu", "preset": "list"}' >s.json
refuse 1 'preset: there is no such preset' render --scene s.json -o y.png

# Values that are as far apart as numbers can be, and many points.
echo '[{"Name": "a", "RGBPoints": [-1.7e308, 0, 0, 0, 1.7e308, 1, 1, 1]}, {"RGBPoints": [0,0,0,0,1,1,1,1]}]' >far.json
shown wide far.json:a
same wide.png shadow.png
awk 'BEGIN { printf "[{\"ColorSpace\": \"Lab\", \"RGBPoints\": [0, 0, 0, 0"
  for (i = 1; i < 1024; i++) printf ", %d, %g, %g, 0.5", i, i / 1024, i % 7 / 7
  print "]}]" }' >many.json
shown smooth many.json
finish
