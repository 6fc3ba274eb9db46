#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# layers.sh SOURCE: a folder of src may include only from itself and from folders above it, io and cli nothing but the
# public headers; only one file knows Embree, only an adapter its library.
set -eu
cd "$1"
status=0

complain() {
  echo "layers: $1" >&2
  status=1
}

# check FOLDER ALLOWED…: each #include "…" in FOLDER names a file of FOLDER, or, from src, an allowed file or one of an allowed folder.
check() {
  folder=$1
  shift
  for file in $(find "src/$folder" -name '*.[ch]' -o -name '*.cpp' -o -name '*.in'); do
    for header in $(sed -n 's/^[[:space:]]*#[[:space:]]*include[[:space:]]*"\([^"]*\)".*/\1/p' "$file"); do
      [ -f "src/$folder/$header" ] && [ "${header#*..}" = "$header" ] && continue
      allowed=false
      for other in "$@"; do
        case $header in
          *..*) ;;
          "$other" | "$other"/*) allowed=true ;;
        esac
      done
      $allowed || complain "$file includes \"$header\", which is not above it"
    done
  done
}

above=''
for folder in base mesh optics traverse render; do
  # shellcheck disable=SC2086  # a list of folders
  check $folder $above $folder
  above="$above $folder"
done
# shellcheck disable=SC2086
check tetcast.c $above
check cli cli
for adapter in src/io/*/; do
  check "io/$(basename "$adapter")" io/floating.hpp
done

# Optics knows no mesh.
for file in $(grep -rlE '#[[:space:]]*include[[:space:]]*["<](mesh/|tetcast/mesh)' src/optics); do
  complain "$file includes a header of meshes"
done
# only PATTERN FILE…: an #include that matches PATTERN stands nowhere else in src and include.
only() {
  pattern=$1
  shift
  for file in $(grep -rlE "#[[:space:]]*include[[:space:]]*[\"<]($pattern)" src include --include='*.[ch]' --include='*.cpp' --include='*.in'); do
    allowed=false
    for place in "$@"; do
      case $file in
        "$place"*) allowed=true ;;
      esac
    done
    $allowed || complain "$file includes $pattern, which belongs to $*"
  done
}
only 'embree|rtcore' src/traverse/embree.c
only 'vtk[A-Z]' src/io/vtk/
only 'tetgen\.h' src/io/tetgen/
only 'OpenImageIO' src/io/openimageio/
only 'jansson' src/cli/
# The core knows nothing of the adapters' headers.
for file in $(grep -rlE '#[[:space:]]*include[[:space:]]*<tetcast/(dataset|surface|tetgen|image)\.h>' src/base src/mesh src/optics \
  src/traverse src/render src/tetcast.c include/tetcast/tetcast.h); do
  complain "$file includes an adapter's header"
done
exit $status
