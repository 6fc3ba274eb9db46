#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# install.sh SOURCE BUILD WORK: installs BUILD, moves the installed tree, and builds and runs tests/examples against it, with
# CMake and with pkg-config. Environment: CC, FORTRAN (a compiler, or empty), ADAPTERS (separated by spaces), CATALYST (empty: not built).
set -eu
source=$1 build=$2 work=$3
rm -rf "$work"
mkdir -p "$work"

fail() {
  echo "install: $1" >&2
  exit 1
}
# quietly COMMAND…: its output is shown only when it fails.
quietly() {
  "$@" >"$work/log" 2>&1 || {
    cat "$work/log" >&2
    fail "failed: $*"
  }
}

quietly cmake --install "$build" --prefix "$work/first"
mv "$work/first" "$work/moved"
prefix=$work/moved

# Nothing installed may know where it was built or first installed; in libraries, messages may name a source file.
{ grep -rlF -e "$build" -e "$work/first" "$prefix" || grep -rlIF -e "$source" "$prefix"; } >"$work/log" &&
  fail "installed files know the build: $(cat "$work/log")"
for file in "$prefix"/lib*/*.so "$prefix"/lib/*/*.so "$prefix"/bin/* "$prefix"/libexec/tetcast/*; do
  [ -f "$file" ] || continue
  path=$(readelf -d "$file" | sed -n 's/.*(R.*PATH).*\[\(.*\)\]/\1/p')
  case $path in
    "\$ORIGIN"* | '') ;;
    *) fail "$file looks for libraries in $path" ;;
  esac
done

# run FOLDER: the examples that were built there.
run() {
  for example in minimal diffusion sight ${FORTRAN:+heat}; do
    (cd "$1" && quietly "./$example" && cp "$work/log" "$example.log") || exit 1
  done
  for picture in minimal.ppm "$2"; do
    [ -s "$1/$picture" ] || fail "$1: $picture was not written"
  done
}
# shows FILE: a PPM picture has hundreds of different bytes: it shows something.
shows() {
  [ "$(od -An -v -tu1 -w1 "$1" | sort -u | wc -l)" -gt 50 ] || fail "$1 shows nothing"
}

# 1. CMake
picture=diffusion.ppm
case " $ADAPTERS " in
  *" openimageio "*) picture=diffusion.png ;;
esac
quietly cmake -S "$source/tests/examples" -B "$work/cmake" -DCMAKE_PREFIX_PATH="$prefix" -DCMAKE_C_COMPILER="$CC" \
  -DCMAKE_Fortran_COMPILER="${FORTRAN:-NOTFOUND}" -DCMAKE_C_FLAGS="-O2 -Wall -Wextra -Wpedantic -Wconversion -Werror"
quietly cmake --build "$work/cmake"
run "$work/cmake" $picture
shows "$work/cmake/minimal.ppm"
[ -z "${FORTRAN-}" ] || shows "$work/cmake/heat4.ppm"

# Every adapter is found by name, with VTK's and everybody else's CMake packages out of sight; a version or component that
# isn't there is refused.
client() {
  rm -rf "$work/client"
  mkdir "$work/client"
  {
    echo 'cmake_minimum_required(VERSION 3.16)'
    echo 'project(client LANGUAGES C)'
    echo "find_package(tetcast $1)"
    shift
    echo 'file(WRITE ${CMAKE_BINARY_DIR}/client.c "int main(void) { return 0; }\n")'
    echo 'add_executable(client ${CMAKE_BINARY_DIR}/client.c)'
    for target in "$@"; do
      echo "target_link_libraries(client PRIVATE tetcast::$target)"
    done
  } >"$work/client/CMakeLists.txt"
  cmake -S "$work/client" -B "$work/client/build" -DCMAKE_PREFIX_PATH="$prefix" -DCMAKE_C_COMPILER="$CC" \
    -DCMAKE_DISABLE_FIND_PACKAGE_VTK=ON -DCMAKE_DISABLE_FIND_PACKAGE_embree=ON >"$work/log" 2>&1 &&
    cmake --build "$work/client/build" >>"$work/log" 2>&1
}
for adapter in $ADAPTERS; do
  client "REQUIRED COMPONENTS $adapter" "$adapter" || fail "component $adapter can't be used: $(cat "$work/log")"
done
client "REQUIRED COMPONENTS fortran" tetcast && fail "the Fortran module was found in a project without Fortran"
grep -q 'enabled Fortran' "$work/log" || fail "the message does not name Fortran: $(cat "$work/log")"
client "99 REQUIRED" tetcast && fail "version 99 was found"
client "REQUIRED COMPONENTS nonesuch" tetcast && fail "component nonesuch was found"
grep -q 'no component "nonesuch"' "$work/log" || fail "the message does not name the component: $(cat "$work/log")"

# 2. pkg-config
PKG_CONFIG_PATH=$(dirname "$(find "$prefix" -name tetcast.pc)")
export PKG_CONFIG_PATH
export LD_LIBRARY_PATH="$(pkg-config --variable=libdir tetcast)"
mkdir "$work/pkg-config"
cd "$source/tests/examples"
# shellcheck disable=SC2046  # a list of options
quietly "$CC" minimal.c $(pkg-config --cflags --libs tetcast) -o "$work/pkg-config/minimal"
# shellcheck disable=SC2046
quietly "$CC" diffusion.c kuhn.c $(pkg-config --cflags --libs tetcast) -lm -o "$work/pkg-config/diffusion"
# shellcheck disable=SC2046
quietly "$CC" sight.c kuhn.c $(pkg-config --cflags --libs tetcast) -lm -o "$work/pkg-config/sight"
if [ -n "${FORTRAN-}" ]; then
  # shellcheck disable=SC2046
  (cd "$work/pkg-config" && quietly "$FORTRAN" "$(pkg-config --variable=fortran tetcast)" "$source/tests/examples/heat.f90" \
    $(pkg-config --libs tetcast) -o heat) || exit 1
fi
run "$work/pkg-config" diffusion.ppm
[ -z "${FORTRAN-}" ] || cmp "$work/cmake/heat4.ppm" "$work/pkg-config/heat4.ppm" || fail "the two builds of heat.f90 differ in their pictures"
shows "$work/pkg-config/diffusion.ppm"
cmp "$work/cmake/minimal.ppm" "$work/pkg-config/minimal.ppm" || fail "the two builds of minimal.c differ in their pictures"
for adapter in $ADAPTERS; do
  quietly pkg-config --exists --print-errors "tetcast-$adapter"
  case $(pkg-config --libs "tetcast-$adapter") in
    *"-ltetcast-$adapter"*-ltetcast*) ;;
    *) fail "tetcast-$adapter.pc does not name its libraries" ;;
  esac
done
case " $ADAPTERS " in
  *" mpi "*)
    [ -x "$work/cmake/partitioned" ] || fail "the example of several ranks was not built"
    if [ -n "${FORTRAN-}" ]; then
      # shellcheck disable=SC2046
      (cd "$work/pkg-config" && quietly "$FORTRAN" -c $(pkg-config --variable=fortran tetcast) $(pkg-config --variable=fortran tetcast-mpi)) || exit 1
    fi
    ;;
esac
unset LD_LIBRARY_PATH

# What simulations load by name finds its libraries where the tree now lies.
if [ -n "${CATALYST-}" ]; then
  plugin=$(find "$prefix" -path '*/catalyst/libcatalyst-tetcast.so')
  [ -n "$plugin" ] || fail "libcatalyst-tetcast.so is not installed in a folder catalyst of the libraries"
  ldd "$plugin" | grep -F "=> $prefix/" | grep -q 'libtetcast[.]so' || fail "$plugin does not find libtetcast: $(ldd "$plugin")"
  [ -n "$(find "$prefix" -name 'tetcast-catalyst.7*')" ] || fail "the manual page tetcast-catalyst.7 is not installed"
fi

# 3. The command finds its libraries where the tree now lies.
if [ -x "$prefix/bin/tetcast" ]; then
  quietly "$prefix/bin/tetcast" --version
  for page in tetcast.1 tetcast-render.1 tetcast-files.7; do
    [ -n "$(find "$prefix" -name "$page*")" ] || fail "the manual page $page is not installed"
  done
  for file in bash-completion/completions/tetcast zsh/site-functions/_tetcast fish/vendor_completions.d/tetcast.fish; do
    [ -s "$prefix/share/$file" ] || fail "share/$file is not installed"
  done
  "$prefix/bin/tetcast" completion bash | cmp - "$prefix/share/bash-completion/completions/tetcast" || fail "another completion is installed"
  mesh=$(find "$source/meshes" -name '*.vtu' | sort | head -n 1)
  case " $ADAPTERS " in
    *" vtk "*" openimageio "*)
      [ -n "$mesh" ] || fail "meshes/ has no .vtu"
      quietly "$prefix/bin/tetcast" render "$mesh" --size 64x64 -o "$work/installed.png"
      [ -s "$work/installed.png" ] || fail "the installed command wrote no picture"
      ;;
  esac

  # And so do the programs that read a file each.
  printf 'FORMAT\ntype: ensight\nGEOMETRY\nmodel: e.geo\n' >"$work/e.case"
  printf '%s\n' e e 'node id off' 'element id off' coordinates 4 >"$work/e.geo"
  printf '%12.5e%12.5e%12.5e\n' 0 0 0 1 0 0 0 1 0 0 0 1 >>"$work/e.geo"
  printf '%s\n' 'part 1' part tetra4 1 '       1       2       3       4' >>"$work/e.geo"
  if "$prefix/bin/tetcast" info --formats 2>/dev/null | grep -qF .case; then
    quietly "$prefix/bin/tetcast" info "$work/e.case"
  fi
fi
