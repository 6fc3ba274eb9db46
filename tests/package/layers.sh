#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# layers.sh SOURCE: a folder of src may include only from itself and from folders above it, io, mpi and cli nothing but the public headers, whether
# directly or through what they include; optics knows nothing of meshes; only one file knows Embree, only an adapter its library.
set -eu
cd "$1"
status=0

complain() {
  echo "layers: $1" >&2
  status=1
}

# What each file includes, and what that includes in turn. Lines of: file, what it includes in the end, the file where that stands.
reached=$(mktemp)
trap 'rm -f "$reached"' EXIT
find src include -type f ! -name '*.py' ! -name '*.cmake' ! -name CMakeLists.txt | sort | while read -r file; do
  sed -n "s|^[[:space:]]*#[[:space:]]*include[[:space:]]*\([\"<]\)\([^\">]*\)[\">].*|$file \1\2|p" "$file"
done | awk '
  # The file that an include names: of the same folder, of src, or a public header, which may be made from NAME.in. As it stands, if none.
  function file_of(from, name,   folder, word) {
    word = substr(name, 2)
    folder = from
    sub("/[^/]*$", "/", folder)
    if (name ~ /^"/ && exists(folder word)) return folder word
    if (name ~ /^"/ && exists("src/" word)) return "src/" word
    if (exists("include/" word)) return "include/" word
    if (exists("include/" word ".in")) return "include/" word ".in"
    return word
  }
  function exists(path) {
    if (!(path in known)) {
      known[path] = (getline line < path) >= 0
      close(path)
    }
    return known[path]
  }
  function follow(top, from,   i, to) {
    for (i = 1; i <= count[from]; ++i) {
      to = included[from, i]
      if ((top, to) in seen) continue
      seen[top, to] = 1
      print top, to, from
      follow(top, to)
    }
  }
  { included[$1, ++count[$1]] = file_of($1, $2) }
  END { for (file in count) follow(file, file) }' | sort >"$reached"

# check FOLDER ALLOWED…: what files of FOLDER include, in the end, is of FOLDER, of an allowed folder or file of src,
# public, or not of here.
check() {
  folder=$1
  shift
  allowed=$(printf '|src/%s(/|$)' "$folder" "$@")
  while read -r file to from && [ -n "$file" ]; do
    complain "$file includes $to, in $from, which is not above it"
  done <<END
$(awk -v top="^src/$folder(/|\$)" -v allowed="^(include/${allowed})" '$1 ~ top && $2 ~ /^(src|include)\// && $2 !~ allowed' "$reached")
END
}

# never FOLDER PATTERN WHY: nothing that matches PATTERN is included by files of FOLDER in the end.
never() {
  while read -r file to from && [ -n "$file" ]; do
    complain "$file includes $to, in $from: $3"
  done <<END
$(awk -v top="^src/$1(/|\$)" -v what="$2" '$1 ~ top && $2 ~ what' "$reached")
END
}

core='base mesh optics volume walk gather render'
above=''
for folder in $core; do
  # shellcheck disable=SC2086  # a list of folders
  check $folder $above
  above="$above $folder"
done
# shellcheck disable=SC2086
check tetcast.c $above
check cli
check catalyst cli # what makes pictures there
check mpi
for adapter in src/io/*/; do
  check "io/$(basename "$adapter")" io/floating.hpp
done
for folder in src/*/; do
  case " $core io cli catalyst fortran mpi " in
    *" $(basename "$folder") "*) ;;
    *) complain "$folder is not one of the folders that are tested" ;;
  esac
done

never optics '^src/mesh/|^include/tetcast/(mesh|field|cells|volume|scene|frame|dataset|surface)[.]h$' 'optics knows no mesh'
for folder in $core tetcast.c; do
  never $folder '^include/tetcast/(dataset|surface|tetgen|image|mpi)[.]h$' 'the core knows no adapter'
done
if grep -E '^include/tetcast/tetcast[.]h include/tetcast/(dataset|surface|tetgen|image|mpi)[.]h ' "$reached"; then
  complain "the header of all of the core includes an adapter's"
fi
while read -r file _ && [ -n "$file" ]; do
  complain "$file includes itself in the end"
done <<END
$(awk '$1 == $2' "$reached")
END

# A file and its header are one; no two such include each other, by whatever way round.
while read -r one other && [ -n "$one" ]; do
  complain "$one and $other include each other"
done <<END
$(awk '
  function pair(file) { sub(/[.][^.]*$/, "", file); return file }
  function follow(top, from,   i, to) {
    for (i = 1; i <= count[from]; ++i) {
      to = next_of[from, i]
      if ((top, to) in seen) continue
      seen[top, to] = 1
      follow(top, to)
    }
  }
  $1 == $3 && $2 ~ /^src/ { a = pair($1); b = pair($2); if (a != b) next_of[a, ++count[a]] = b }
  END {
    for (top in count) follow(top, top)
    for (both in seen) { split(both, e, SUBSEP); if (e[1] < e[2] && (e[2], e[1]) in seen) print e[1], e[2] }
  }' "$reached")
END

while read -r file to _ && [ -n "$file" ]; do
  complain "$file includes $to: by a path of its own"
done <<END
$(awk '$1 == $3 && $2 ~ /[.][.]/' "$reached")
END

# only PATTERN FILE…: an #include that matches PATTERN stands nowhere else in src and include.
only() {
  pattern=$1
  shift
  for file in $(awk -v what="^($pattern)" '$1 == $3 && $2 ~ what { print $1 }' "$reached" | sort -u); do
    allowed=false
    for place in "$@"; do
      case $file in
        "$place"*) allowed=true ;;
      esac
    done
    $allowed || complain "$file includes $pattern, which belongs to $*"
  done
}
only 'embree|rtcore' src/volume/embree.c
only 'vtk[A-Z]' src/io/vtk/
only 'tetgen[.]h' src/io/tetgen/
only 'OpenImageIO' src/io/openimageio/
only 'jansson' src/cli/ src/catalyst/settings.c
only 'mpi[.]h' src/mpi/

# That the test sees anything at all.
for line in 'src/render/picture.c src/mesh/adjacency.h src/volume/volume.h' 'src/volume/embree.c embree' 'src/optics/transfer.c src/base/base.h'; do
  grep -q "^$line" "$reached" || complain "'$line' was not found: the test does not see what is included"
done
exit $status
