# SPDX-License-Identifier: Apache-2.0
# Every file that other programs wrote becomes a picture, or is refused in one line that says why.
. "$(dirname "$0")/lib.sh"
needs vtk openimageio
if [ ! -d "$TETCAST_DATA/cells" ]; then
  echo "skipped: no datasets in '$TETCAST_DATA'"
  exit 77
fi

# Formats of readers that the build may lack.
formats=$("$tetcast" info --formats)
lacks() { ! grep -qF -- "$1" <<<"$formats"; }

# The reason why a file is not read, by info and render alike; "" for those that are.
reason() {
  case $1 in
    INDEX.md | surfaces/*.poly | surfaces/*.stl | cells/ensight/*.geo | cells/ensight/*.[EN]*)
      echo 'is not a file of a volume mesh in a known format (.vtu ' ;;
    surfaces/*.off) echo 'holds OFF data, not a volume mesh: a surface, which tetcast mesh fills with tetrahedra' ;;
    defects/Armadillo_Tetra_4406_for_test_broken.vtu) echo 'the "offsets" array is not long enough' ;;
    defects/lv_fiber.vtk) echo 'holds no volumetric cells, only 1 × poly-vertex' ;;
  esac
}

rendered=0
while read -r name; do
  file=$TETCAST_DATA/$name
  why=$(reason "$name")
  if [ -n "$why" ]; then
    refuse 1 "$file: " info "$file"
    refuse 1 "$why" render "$file" --size 64x64 -o no.png
    continue
  fi
  case $name in
    cells/polyhedron2pieces.vtu | defects/Bunny.vtk) # meshes without fields
      accept info "$file"
      warn 'has no arrays: drawn as uniform matter' render "$file" --size 64x64 -o a.png
      exists a.png
      rm -f a.png
      continue ;;
    *.case) if lacks .case; then continue; fi ;;
    *.hdf) if lacks .hdf; then continue; fi ;;
    *.e | *.ex2) if lacks .ex2; then continue; fi ;;
  esac
  case $name in
    defects/notch_stress.vtk) warn 'have more points than their type has' render "$file" --size 64x64 -o a.png ;;
    cells/supportedElements*.vtk | cells/box_hybrid_mesh.vtu) # with materials alone
      warn "in the colours of 'attribute'" render "$file" --size 64x64 -o a.png ;;
    cells/can-vtu.hdf | volumes/can.vtu) warn 'are far from convex or tangled' render "$file" --size 64x64 -o a.png ;;
    *) accept render "$file" --size 64x64 -o a.png ;;
  esac
  exists a.png
  rm -f a.png
  rendered=$((rendered + 1))
done < <(cd "$TETCAST_DATA" && find . -path ./faults -prune -o -type f -print | sed 's|^\./||' | sort)
[ "$rendered" -ge 90 ] || fail "only $rendered files became pictures"

# In pieces, with ghosts and without, as a whole.
for name in ascii.vtu pieces.pvtu pieces_ghost.pvtu; do
  accept render "$TETCAST_DATA/encodings/$name" --size 64x48 --pixel-type float -o "$name.exr"
done
same ascii.vtu.exr pieces.pvtu.exr
same ascii.vtu.exr pieces_ghost.pvtu.exr
finish
