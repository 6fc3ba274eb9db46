# SPDX-License-Identifier: Apache-2.0
# How a camera that is given in part, or by a name, is completed, as the saved scene states it.
. "$(dirname "$0")/lib.sh"
needs vtk openimageio
vtu cube.vtu "$five_tetrahedra" 10

# camera ARGUMENTS…: the camera as one line, numbers rounded.
camera() {
  accept render "${file:-cube.vtu}" -o a.png --size "${size:-20x20}" --save-scene s.json "$@"
  output=$(tr -d ' \n' <s.json | sed 's/.*"camera"://; s/}.*//' | sed -E 's/([0-9]\.[0-9]{4})[0-9]*/\1/g')
}

# looks X Y Z UX UY UZ [ARGUMENTS…]: the eye is in this direction from the target, and that is up.
looks() {
  local want="$1 $2 $3 $4 $5 $6"
  shift 6
  camera "$@"
  checks=$((checks + 1))
  LC_ALL=C awk -v want="$want" -v camera="$output" '
    function numbers(key, to, text, n) {
      text = camera
      sub(".*\"" key "\":\\[", "", text)
      sub("\\].*", "", text)
      return split(text, to, ",")
    }
    BEGIN {
      split(want, w, " ")
      numbers("eye", eye)
      numbers("target", target)
      numbers("up", up)
      for (k = 1; k <= 3; k++) length2 += (eye[k] - target[k]) ^ 2
      for (k = 1; k <= 3; k++) {
        bad += (eye[k] - target[k]) / sqrt(length2) - w[k] > 2e-4 || w[k] - (eye[k] - target[k]) / sqrt(length2) > 2e-4
        bad += up[k] - w[k + 3] > 2e-4 || w[k + 3] - up[k] > 2e-4
      }
      exit bad > 0
    }' || fail "camera of '$*': wanted $want, not $output"
}

looks 0.4532 -0.7849 0.4226 -0.2113 0.3660 0.9063
looks 0.4532 -0.7849 0.4226 -0.2113 0.3660 0.9063 --view iso
looks 0.4532 -0.7849 0.4226 -0.2113 0.3660 0.9063 --azimuth 30 --elevation 25
looks 0.4532 -0.7849 0.4226 -0.2113 0.3660 0.9063 --target 1,2,3
looks -1 0 0 0 0 1 --view +x
looks 1 0 0 0 0 1 --view -x
looks 0 -1 0 0 0 1 --view +y
looks 0 1 0 0 0 1 --view -y
looks 0 0 -1 0 1 0 --view +z
looks 0 0 1 0 1 0 --view -z
looks 0 -1 0 0 0 1 --azimuth 0 --elevation 0
looks 1 0 0 0 0 1 --azimuth 90 --elevation 0
looks 0 1 0 0 0 1 --azimuth -180 --elevation 0
looks 0 0 1 0 1 0 --azimuth 0 --elevation 90
looks 0 0 -1 0 1 0 --azimuth 180 --elevation -90
looks 0 0 1 0 1 0 --up 0,1,0 --azimuth 0 --elevation 0
looks 1 0 0 0 1 0 --up 0,1,0 --azimuth 90 --elevation 0
looks 0.4532 0.4226 0.7849 0 2 0 --up 0,2,0
looks 0 0 1 0 1 0 --view -z --zoom 3

# All corners of the bounds are in the picture, in whatever shape it has, and not much room is left.
corners() { # SIZE ARGUMENTS…
  size=$1 camera "${@:2}"
  checks=$((checks + 1))
  LC_ALL=C awk -v size="$1" -v camera="$(tr -d ' \n' <s.json | sed 's/.*"camera"://')" '
    function numbers(key, to, text) {
      text = camera
      sub(".*\"" key "\":\\[?", "", text)
      sub("[]}].*", "", text)
      split(text, to, ",")
    }
    function cross(a, b, c, k) { for (k = 0; k < 3; k++) c[k + 1] = a[(k + 1) % 3 + 1] * b[(k + 2) % 3 + 1] - a[(k + 2) % 3 + 1] * b[(k + 1) % 3 + 1] }
    function unit(a, l, k) { l = sqrt(a[1] ^ 2 + a[2] ^ 2 + a[3] ^ 2); for (k = 1; k <= 3; k++) a[k] /= l }
    BEGIN {
      split(size, wh, "x")
      numbers("eye", eye); numbers("target", target); numbers("up", up); numbers("fovy", fovy)
      for (k = 1; k <= 3; k++) forward[k] = target[k] - eye[k]
      unit(forward); cross(forward, up, right); unit(right); cross(right, forward, top)
      tangent = sin(fovy[1] * 0.00872664626) / cos(fovy[1] * 0.00872664626)
      for (i = 0; i < 8; i++) {
        p[1] = i % 2; p[2] = int(i / 2) % 2; p[3] = int(i / 4)
        x = y = z = 0
        for (k = 1; k <= 3; k++) { d = p[k] - eye[k]; x += d * right[k]; y += d * top[k]; z += d * forward[k] }
        x /= z * tangent * wh[1] / wh[2]; y /= z * tangent
        left = -x > left ? -x : left; far = x > far ? x : far; high = y * y > high * high ? y : high
      }
      high = high < 0 ? -high : high
      exit !(left < 0.921 && far < 0.701 && high < 0.901 && (left + far > 1.61 || high > 0.899))
    }' || fail "corners of $*: $output"
}
corners 20x20
corners 40x20 --view -y
corners 20x40 --fovy 80 --azimuth 77 --elevation -40
corners 90x10 --up 1,2,3
corners 30x20 --view iso

camera --eye 5,5,5
contains '"eye":\[5.0,5.0,5.0\],"target":\[0.5,0.5,0.5\],"up":\[0.0,1.0,0.0\]'
camera --eye 0.5,7,0.5
contains '"target":\[0.5,0.5,0.5\],"up":\[0.0,0.0,1.0\]'
camera --eye 0.5,0.5,0.5
contains '"eye":\[0.5,0.5,0.5\],"target":\[0.5,0.5,-'
camera --view -z --ortho 2.5
contains '"eye":\[0.5,0.5,3.8460\].*"ortho":2.5'
refuse 2 'parallel' render cube.vtu -o b.png --eye 5,0.5,0.5 --up 1,0,0
refuse 2 'parallel' render cube.vtu -o b.png --view +x --up 1,0,0
refuse 2 'exclude each other' render cube.vtu -o b.png --view +x --eye 1,2,3
refuse 2 'exclude each other' render cube.vtu -o b.png --zoom 2 --ortho 3
refuse 2 'expected iso, or the direction' render cube.vtu -o b.png --view top
refuse 2 'from -90 to 90' render cube.vtu -o b.png --elevation 91
echo '{"input": "cube.vtu", "camera": {"eye": [5,0.5,0.5], "up": [1,0,0]}}' >parallel.json
refuse 1 'parallel' render --scene parallel.json -o b.png
echo '{"input": "cube.vtu", "camera": {"view": "+y", "fovy": 40}}' >named.json
looks 0 -1 0 0 0 1 --scene named.json
looks 1 0 0 0 0 1 --scene named.json --view -x
contains '"fovy":40'

# A flat mesh is seen from the side that shows it.
scaled() { # FILE X Y Z: the cube with these edges
  vtu "$1" "$five_tetrahedra" 10 "0 0 0  $2 0 0  $2 $3 0  0 $3 0  0 0 $4  $2 0 $4  $2 $3 $4  0 $3 $4"
}
scaled flat_x.vtu 0.01 1 1
scaled flat_y.vtu 1 0.01 1
scaled flat_z.vtu 1 1 0.01
scaled long_z.vtu 0.1 0.1 4
scaled half.vtu 1 0.2 1
file=flat_z.vtu looks 0 0 1 0 1 0
file=flat_y.vtu looks 0 -1 0 0 0 1
file=flat_x.vtu looks 1 0 0 0 0 1
size=61x61 file=long_z.vtu looks 0.4532 -0.7849 0.4226 -0.2113 0.3660 0.9063
file=half.vtu looks 0.4532 -0.7849 0.4226 -0.2113 0.3660 0.9063 # not as flat
file=flat_y.vtu looks 0.4532 0.4226 0.7849 0 1 0 --up 0,1,0 # which is along the better view
file=flat_x.vtu looks 1 0 0 0 0 1 --up 0,0,1
file=flat_y.vtu looks 0 -1 0 0 0 1 --target 0,0,0
finish
