# SPDX-License-Identifier: Apache-2.0
# Transfer functions that are curves: the linear pieces that a saved scene has of them are within 1e-4 of the curve's
# height, which is computed here by other means: splines by a dense solution of their equations.
. "$(dirname "$0")/lib.sh"
needs vtk openimageio
vtu cube.vtu "$five_tetrahedra" 10

cat >check.py <<'END'
import bisect, json, math, sys
file = json.load(open(sys.argv[1]))
drawn = json.load(open(sys.argv[2]))["transfer"]

def linear(rows, v):
    if v < rows[0][0]:
        return rows[0][1:]
    i = bisect.bisect_right([row[0] for row in rows], v)
    if i == len(rows):
        return rows[-1][1:]
    a, b = rows[i - 1], rows[i]
    return [p + (q - p) * (v - a[0]) / (b[0] - a[0]) for p, q in zip(a[1:], b[1:])]

def opacities(rows):
    return [[v, -math.log1p(-a) / file.get("unit_distance", 1)] for v, a in rows]

def solve(matrix, right): # Gauss with pivots
    n = len(right)
    rows = [line[:] + [b] for line, b in zip(matrix, right)]
    for i in range(n):
        p = max(range(i, n), key=lambda k: abs(rows[k][i]))
        rows[i], rows[p] = rows[p], rows[i]
        for k in range(i + 1, n):
            f = rows[k][i] / rows[i][i]
            rows[k] = [x - f * y for x, y in zip(rows[k], rows[i])]
    x = [0] * n
    for i in reversed(range(n)):
        x[i] = (rows[i][n] - sum(rows[i][k] * x[k] for k in range(i + 1, n))) / rows[i][i]
    return x

def spline(rows): # cubics a + b t + c t^2 + d t^3, four unknowns each: values, slopes and curvatures agree
    n, result = len(rows) - 1, []
    for channel in range(1, len(rows[0])):
        matrix, right = [], []
        def equation(terms, value):
            line = [0] * (4 * n)
            for at, factor in terms:
                line[at] = factor
            matrix.append(line)
            right.append(value)
        for i in range(n):
            h = rows[i + 1][0] - rows[i][0]
            equation([(4 * i, 1)], rows[i][channel])
            equation([(4 * i + k, h ** k) for k in range(4)], rows[i + 1][channel])
            if i + 1 < n:
                equation([(4 * i + 1, 1), (4 * i + 2, 2 * h), (4 * i + 3, 3 * h * h), (4 * i + 5, -1)], 0)
                equation([(4 * i + 2, 2), (4 * i + 3, 6 * h), (4 * i + 6, -2)], 0)
        equation([(2, 2)], 0)
        equation([(4 * n - 2, 2), (4 * n - 1, 6 * (rows[n][0] - rows[n - 1][0]))], 0)
        result.append(solve(matrix, right))
    def at(v):
        i = min(max(bisect.bisect_right([row[0] for row in rows], v) - 1, 0), n - 1)
        t = min(max(v, rows[0][0]), rows[n][0]) - rows[i][0]
        return [max(sum(x[4 * i + k] * t ** k for k in range(4)), 0) for x in result]
    return at

def logarithm(rows):
    over = [[math.log(row[0])] + row[1:] for row in rows]
    return lambda v: linear(over, math.log(v))

if "gaussians" in file:
    def height(g):
        return opacities([[0, g["opacity"]]])[0][1] if "opacity" in g else g["extinction"]
    bells = [(g.get("centre", g.get("center")), g["width"], height(g), g.get("colour", g.get("color")))
             for g in file["gaussians"]]
    def exponents(v):
        return [math.log(e) - ((v - c) / w) ** 2 / 2 if e > 0 else -math.inf for c, w, e, _ in bells]
    def extinction(v):
        return [sum(math.exp(q) for q in exponents(v))]
    def color(v):
        most = max(exponents(v))
        weights = [math.exp(q - most) for q in exponents(v)]
        return [sum(p * bell[3][k] for p, bell in zip(weights, bells)) / sum(weights) for k in range(3)]
    heights = [max(b[2] for b in bells), max(max(b[3]) for b in bells)]
else:
    knots = opacities(file["opacity"]) if "opacity" in file else file["extinction"]
    curve = spline if file.get("spline") else logarithm if file.get("log") else lambda rows: lambda v: linear(rows, v)
    extinction, color = curve(knots), curve(file["color"])
    heights = [max(row[1] for row in knots), max(max(row[1:]) for row in file["color"])]

worst = [0, 0]
for which, rows, curve in (0, drawn["extinction"], extinction), (1, drawn["color"], color):
    positions = [row[0] for row in rows]
    length = positions[-1] - positions[0]
    samples = [positions[0] + length * i / 5000 for i in range(5000)]
    samples += [a + (b - a) * t for a, b in zip(positions, positions[1:]) if b > a for t in (0.21, 0.5, 0.79)]
    if not file.get("log") and which == 0:
        samples += [positions[0] - length * 0.3, positions[-1] + length * 0.3]
    for v in samples:
        for p, q in zip(linear(rows, v), curve(v)):
            assert p >= 0
            worst[which] = max(worst[which], abs(p - q) / heights[which])
count = [len(drawn["extinction"]) - 1, len(drawn["color"]) - 1]
print("%g %g with %d and %d pieces" % (*worst, *count))
sys.exit(0 if max(worst) <= 1e-4 and max(count) <= int(sys.argv[3]) and max(worst) >= float(sys.argv[4]) else 1)
END

# curve MOST TEXT: a function of no more than MOST pieces, near to its curve; the note says how many there are.
curve() {
  echo "$2" >t.json
  checks=$((checks + 1)) # whatever there is to be seen of it
  "$tetcast" render cube.vtu --transfer t.json --size 9x9 -o t.png --save-scene s.json 2>"$work.err" || fail "$(cat "$work.err")"
  said=$(python3 check.py t.json s.json "$1" "${3:-1e-5}" 2>&1) || fail "$said: $2"
  said=${said% pieces*}
  grep -q "t.json: the curve is drawn as linear pieces, $(echo "${said#*with }" | sed 's/ and / of extinction and /') of colour$" \
    "$work.err" || fail "no note of $said: $(cat "$work.err")"
}

red='"colour": [1,0,0]' blue='"color": [0,0.2,0.9]'
curve 400 "{\"gaussians\": [{\"centre\": 2, \"width\": 0.3, \"extinction\": 4, $red}]}"
curve 700 "{\"gaussians\": [{\"centre\": 2, \"width\": 0.5, \"extinction\": 4, $red},
  {\"center\": 4, \"width\": 1, \"extinction\": 1.5, $blue}, {\"centre\": 3, \"width\": 0.4, \"extinction\": 0, $red}]}"
# Of unlike widths, far apart; the narrow one in the wide one; and beyond all data.
curve 1500 "{\"gaussians\": [{\"centre\": 1, \"width\": 0.001, \"extinction\": 40, $red},
  {\"centre\": 5, \"width\": 1, \"extinction\": 1, $blue}, {\"centre\": 5.1, \"width\": 0.01, \"extinction\": 7, $red}]}"
curve 700 "{\"gaussians\": [{\"centre\": -1e6, \"width\": 5e5, \"extinction\": 1e9, $red},
  {\"centre\": -1.1e6, \"width\": 1e4, \"extinction\": 2e9, $blue}]}"
curve 700 "{\"gaussians\": [{\"centre\": 2, \"width\": 0.5, \"opacity\": 0.9, $red},
  {\"centre\": 4, \"width\": 1, \"opacity\": 0.2, $blue}], \"unit_distance\": 0.25}"
curve 300 '{"color": [[0,1,0,0],[2,0,1,0],[6,0,0,1]], "extinction": [[0,0],[1,3],[2,0.5],[5,0.6],[6,0]], "spline": true}'
# One that swings below 0 and is cut there, in colour as well; unevenly spaced.
curve 1200 '{"color": [[0,1,0,0],[0.1,0,0,1],[3,0,1,0.01],[3.5,1,0,0],[6,0,0,1]], "spline": true,
  "extinction": [[-1,5],[1,0],[2,0],[2.5,9],[2.6,0],[7,0]]}'
grep -q 'extinction: the spline swings below 0, where it is cut' "$work.err" || fail "no note: $(cat "$work.err")"
curve 300 '{"color": [[0,1,0,0],[2,0,1,0],[6,0,0,1]], "opacity": [[0,0],[3,0.99],[6,0.1]], "unit_distance": 3, "spline": true}'
curve 400 '{"color": [[0.001,1,0,0],[0.1,0,1,0],[6,0,0,1]], "extinction": [[1e-9,0],[0.5,0.5],[6,3]], "log": true}'
curve 400 '{"color": [[1,1,0,0]], "extinction": [[0.5,0],[1,0.5],[1,2],[1.0000001,3],[6,0]], "log": true}'
# What the library takes stays as it is.
echo '{"color": [[0,1,0,0],[6,0,0,1]], "extinction": [[0,0],[6,3]], "log": false, "spline": false}' >t.json
accept render cube.vtu --transfer t.json --size 9x9 -o t.png --save-scene s.json
grep -q pieces "$work.err" && fail "a note without a curve: $(cat "$work.err")"
python3 check.py t.json s.json 1 0 >/dev/null || fail 'control points without a curve'

# A gaussian of zero height shows nothing; rows may be curves as well, and a saved scene gives the same picture.
echo "{\"gaussians\": [{\"centre\": 2, \"width\": 1, \"extinction\": 0, $red}]}" >t.json
warn 'the extinction is 0 for all values' render cube.vtu --transfer t.json --size 9x9 -o t.png
echo "{\"second\": \"gradient\", \"rows\": [{\"at\": 1, \"gaussians\": [{\"centre\": 2, \"width\": 0.5, \"extinction\": 4, $red}]},
  {\"at\": 9, \"color\": [[1,1,1,1]], \"extinction\": [[1,1],[2,3],[6,0]], \"log\": true}]}" >t.json
accept render cube.vtu --transfer t.json --size 20x20 -o t.tif --save-scene s.json
accept render --scene s.json -o again.tif
same t.tif again.tif
echo "{\"gaussians\": []}" >t.json
refuse 2 'is a transfer function, not a mesh' render t.json

# What can't be.
bad() {
  echo "$2" >t.json
  refuse 1 "$1" render cube.vtu --transfer t.json --size 9x9 -o bad.png
}
form='expected {"centre": value, "width": w'
bad 'gaussians[0]: width: expected a number above 0' \
  "{\"gaussians\": [{\"centre\": 2, \"width\": 0, \"extinction\": 4, $red}]}"
bad 'gaussians[1]: width: expected a number above 0' \
  "{\"gaussians\": [{\"centre\": 2, \"width\": 1, \"extinction\": 4, $red}, {\"centre\": 2, \"width\": -1, \"extinction\": 4, $red}]}"
bad 'width: too small beside the centre' "{\"gaussians\": [{\"centre\": 2, \"width\": 1e-15, \"extinction\": 4, $red}]}"
bad 'extinction: expected a number, 0 or above' \
  "{\"gaussians\": [{\"centre\": 2, \"width\": 1, \"extinction\": -4, $red}]}"
bad 'opacity: expected a number from 0 to 1' "{\"gaussians\": [{\"centre\": 2, \"width\": 1, \"opacity\": 1.5, $red}]}"
bad 'colour: expected three numbers, 0 or above' \
  '{"gaussians": [{"centre": 2, "width": 1, "extinction": 4, "colour": [1,-1,0]}]}'
for text in '"width": 1, "extinction": 4, "colour": [1,1,1]' '"centre": 2, "width": 1, "extinction": 4, "colour": [1,1]' \
  '"centre": 2, "width": 1, "extinction": 4, "colour": [1,1,1], "height": 2' '"centre": "2", "width": 1, "extinction": 4, "colour": [1,1,1]' \
  '"centre": 2, "width": 1, "extinction": 4, "opacity": 1, "colour": [1,1,1]'; do
  bad "gaussians[0]: $form" "{\"gaussians\": [{$text}]}"
done
bad "gaussians[1]: $form" "{\"gaussians\": [{\"centre\": 2, \"width\": 1, \"opacity\": 0.5, $red}, {\"centre\": 2, \"width\": 1, \"extinction\": 1, $red}]}"
alone='expected a list of them, and beside it no more than "unit_distance"'
bad "$alone" "{\"gaussians\": []}"
bad "$alone" "{\"gaussians\": 3}"
bad "$alone" "{\"gaussians\": [{\"centre\": 2, \"width\": 1, \"extinction\": 4, $red}], \"color\": [[1,1,1,1]]}"
bad "$alone" "{\"gaussians\": [{\"centre\": 2, \"width\": 1, \"extinction\": 4, $red}], \"log\": true}"
bad 'unit_distance: belongs to "opacity"' "{\"gaussians\": [{\"centre\": 2, \"width\": 1, \"extinction\": 4, $red}], \"unit_distance\": 1}"
bad 'unit distance 0 is not a positive length' "{\"gaussians\": [{\"centre\": 2, \"width\": 1, \"opacity\": 0.5, $red}], \"unit_distance\": 0}"
bad 'more than 65536 linear pieces' "{\"gaussians\": [$(for i in $(seq 300); do
  echo "{\"centre\": $i, \"width\": 0.01, \"extinction\": 4, $red},"
done) {\"centre\": 2, \"width\": 1, \"extinction\": 4, $red}]}"
for text in NaN -Infinity 1e999; do
  bad 't.json:1: ' "{\"gaussians\": [{\"centre\": $text, \"width\": 1, \"extinction\": 4, $red}]}"
done
white='"color": [[1,1,1,1],[2,1,1,1],[3,1,1,1]]'
bad 't.json: extinction: a spline goes through three points or more, not 2' "{$white, \"extinction\": [[1,1],[2,1]], \"spline\": true}"
bad 't.json: color: a spline goes through three points or more, not 1' '{"color": [[1,1,1,1]], "extinction": [[1,1],[2,1],[3,4]], "spline": true}'
bad 'extinction[2]: the value 2 is there twice; a spline has no steps' "{$white, \"extinction\": [[1,1],[2,1],[2,2],[3,1]], \"spline\": true}"
bad 'points are too close to each other, or too high' \
  "{$white, \"extinction\": [[0,1],[1e-300,1e300],[2,0]], \"spline\": true}"
bad 'the value 0 has no logarithm' "{$white, \"extinction\": [[0,1],[2,1]], \"log\": true}"
bad 'color[0]: the value -1 has no logarithm' '{"color": [[-1,1,1,1]], "extinction": [[1,1],[2,1]], "log": true}'
bad '"spline" and "log" exclude each other' "{$white, \"extinction\": [[1,1],[2,1],[3,4]], \"spline\": true, \"log\": true}"
bad 'spline: expected true or false' "{$white, \"extinction\": [[1,1],[2,1],[3,4]], \"spline\": 3}"
for key in spline log; do
  bad 'knot 2' "{$white, \"extinction\": [[1,1],[3,1],[2,4]], \"$key\": true}"
  bad 'knot 1' "{$white, \"extinction\": [[1,1],[2,-1],[3,4]], \"$key\": true}"
done
bad "unknown key 'splines'; did you mean 'spline'?" "{$white, \"extinction\": [[1,1]], \"splines\": true}"
finish
