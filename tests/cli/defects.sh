# SPDX-License-Identifier: Apache-2.0
# Each defect a mesh can have: what is drawn, what `info` counts, what is warned of, and --strict, with which a warning is an error.
. "$(dirname "$0")/lib.sh"
needs vtk openimageio

vtu good.vtu "$five_tetrahedra" 10
view='--size 60x45 --pixel-type float --range 0,6 --eye 0.5,0.5,4 --target 0.5,0.5,0.5'
accept render good.vtu $view -o good.exr --strict
accept info good.vtu --strict
echo '{"color": [[0,1,0,0],[6,0,0,1]], "extinction": [[0,0],[6,5]]}' >t.json
view="--size 60x45 --pixel-type float --transfer t.json --eye 0.5,0.5,4 --target 0.5,0.5,0.5"
accept render good.vtu $view -o good.exr

# defect FILE ROW...: `info` has these rows.
counts() {
  local file=$1 row
  shift
  output=$("$tetcast" info "$file" 2>/dev/null)
  for row; do contains "$row"; done
}
# harmless FILE: the picture of the good mesh, without a word. --strict does not mind.
harmless() {
  accept render "$1" $view -o a.exr --strict
  same a.exr good.exr "$1"
}
# warned TEXT FILE: a picture and one warning; --strict makes it the error, of render, info and converge, and nothing is written.
warned() {
  local text=$1 file=$2
  warn "$text" render "$file" $view -o a.exr
  "$tetcast" render "$file" $view -o a.exr 2>"$work.err"
  without_notes "$work.err"
  [ "$(wc -l <"$work.err")" = 1 ] || fail "$file: $(cat "$work.err")"
  accept render "$file" $view -o quiet.exr --quiet
  same a.exr quiet.exr
  rm -f a.exr quiet.exr "$work.err"
  refuse 1 "$text" render "$file" $view -o b.exr --strict --stats s.json --save-scene s2.json
  refuse 1 "$text" render "$file" $view -o b.exr --strict --quiet
  refuse 1 "$text" converge "$file" --transfer t.json -o report --size 8x6 --repeat 1 --no-plots --strict
}

# Coordinates: the cells that use them are left out, as if they were not there.
rest='1 2 3 6'
for value in nan inf -inf; do
  vtu bad.vtu "$five_tetrahedra" 10 "0 0 0  1 0 0  1 1 0  0 1 0  $value 0 1  1 0 1  1 1 1  0 1 1"
  vtu rest.vtu "$rest" 10
  warn '1 points have coordinates that are NaN or infinite: they are left out, and so are 4 cells' \
    render bad.vtu $view -o a.exr
  accept render rest.vtu $view -o b.exr
  same a.exr b.exr "$value"
  rm a.exr b.exr
  counts bad.vtu '^points +8$' '^  NaN or infinite +1, left out$' '^cells +5$' '^  NaN or infinite +4, left out$' \
    '^tetrahedra +1$' '^bounds +x \[0, 1\]$'
done
warned 'NaN or infinite' bad.vtu
refuse 1 'NaN or infinite' info bad.vtu --strict
vtu bad.vtu '0 1 3 4' 10 'nan 0 0  1 0 0  1 1 0  0 1 0  0 0 1  1 0 1  1 1 1  0 1 1'
refuse 1 'holds no cells without coordinates that are NaN or infinite' render bad.vtu -o a.png
vtu bad.vtu '1 2 3 6' 10 'nan 0 0  1 0 0  1 1 0  0 1 0  0 0 1  1 0 1  1 1 1  0 1 1' # of no cell
warn 'so are 0 cells' render bad.vtu $view -o a.exr
vtu hexahedron.vtu '0 1 2 3 4 5 6 7' 12 'nan 0 0  1 0 0  1 1 0  0 1 0  0 0 1  1 0 1  1 1 1  0 1 1'
refuse 1 'holds no cells without' info hexahedron.vtu
cat >bad.vts <<'END'
<VTKFile type="StructuredGrid" version="0.1" byte_order="LittleEndian"><StructuredGrid WholeExtent="0 2 0 1 0 1"><Piece Extent="0 2 0 1 0 1">
<PointData><DataArray type="Float32" Name="s" format="ascii">0 1 2 0 1 2 0 1 2 0 1 2</DataArray></PointData>
<CellData><DataArray type="Float32" Name="c" format="ascii">5 6</DataArray></CellData>
<Points><DataArray type="Float32" NumberOfComponents="3" format="ascii">
0 0 0 1 0 0 nan 0 0 0 1 0 1 1 0 2 1 0 0 0 1 1 0 1 2 0 1 0 1 1 1 1 1 2 1 1</DataArray></Points>
</Piece></StructuredGrid></VTKFile>
END
counts bad.vts '^  hexahedron +1$' 'NaN or infinite +1, left out' 'point +s +float32 +\[0, 2\]' 'cell +c +float32 +\[5, 5\]'

# Values.
scalar='nan 1 3 2 3 4 6 5' vtu value.vtu "$five_tetrahedra" 10
vtu rest.vtu '1 2 3 6;1 4 5 6;3 4 6 7;1 3 4 6' 10
warn '1 values are NaN or infinite; the cells they touch are transparent' render value.vtu $view -o a.exr
accept render rest.vtu $view -o b.exr
same a.exr b.exr
rm a.exr b.exr
counts value.vtu 's +float64 +\[1, 6\]  1 NaN'
warned 'NaN or infinite' value.vtu
refuse 1 '1 values that are NaN or infinite' info value.vtu --strict

# Cells the other way round: the order of vertices is free.
vtu inverted.vtu '1 0 3 4;1 2 3 6;1 4 5 6;3 4 7 6;1 3 4 6' 10
counts inverted.vtu 'inverted cells +2$' 'volume +1$'
harmless inverted.vtu
refuse 1 '2 tetrahedra inverted and others not' info inverted.vtu --strict
vtu inverted.vtu '1 0 3 4;2 1 3 6;4 1 5 6;4 3 6 7;3 1 4 6' 10
counts inverted.vtu 'inverted cells +5$'
harmless inverted.vtu
accept info inverted.vtu --strict

# Cells of no volume.
vtu flat.vtu "$five_tetrahedra;0 1 2 3" 10
counts flat.vtu 'degenerate cells +1$' 'volume +1$'
accept render flat.vtu $view -o a.exr --strict
refuse 1 '1 tetrahedra without volume' info flat.vtu --strict
vtu twice.vtu "$five_tetrahedra;0 1 1 3" 10
counts twice.vtu 'degenerate cells +1$'
warned '1 with a vertex twice' twice.vtu
accept render twice.vtu $view -o a.exr --quiet
same a.exr good.exr 'a vertex twice'
rm a.exr

# The same cell twice, in another order of vertices.
vtu double.vtu "$five_tetrahedra;4 3 1 0" 10
counts double.vtu 'duplicate cells +1$'
warned '1 duplicates of others' double.vtu
accept render double.vtu $view -o a.exr --quiet
same a.exr good.exr 'a cell twice'
rm a.exr
refuse 1 '1 tetrahedra that another one equals' info double.vtu --strict

# Three cells at one face: two of them overlap.
vtu many.vtu "0 1 3 4;1 3 4 6;1 3 4 7" 10
counts many.vtu 'non-manifold faces +1$'
warned '1 faces have three cells or more' many.vtu
accept render many.vtu $view -o a.exr --traversal faces --strict
refuse 1 '1 faces of three tetrahedra or more' info many.vtu --strict

# Cells that overlap without sharing a face are not looked for; --traversal faces draws them.
vtu overlap.vtu '0 1 3 4;0 2 3 4;1 3 5 7;0 5 6 7' 10
accept render overlap.vtu $view -o a.exr --traversal faces --strict
# Within a cell they are: a hexahedron tangled.
vtu tangled.vtu '0 1 2 3 4 5 6 7' 12 '0 0 0  1 0 0  1 1 0  0 1 0  0 0 1  1 0 1  0.1 0.1 -2  0 1 1'
counts tangled.vtu 'overlapping cells +1$'
warned 'tetrahedra overlap' tangled.vtu

# Points of no cell, cells apart from each other: nothing to say.
vtu apart.vtu '0 1 3 4;1 2 3 6' 10
counts apart.vtu 'components +2$' 'unused vertices +2$' 'bounds +x \[0, 1\]'
accept render apart.vtu $view -o a.exr --strict
accept info apart.vtu --strict

# Pieces without cells and without points; a file of nothing.
cat >empty.vtu <<'END'
<VTKFile type="UnstructuredGrid" version="0.1" byte_order="LittleEndian"><UnstructuredGrid>
<Piece NumberOfPoints="0" NumberOfCells="0"><Points><DataArray type="Float64" NumberOfComponents="3" format="ascii"/></Points>
<Cells><DataArray type="Int64" Name="connectivity" format="ascii"/><DataArray type="Int64" Name="offsets" format="ascii"/>
<DataArray type="UInt8" Name="types" format="ascii"/></Cells></Piece></UnstructuredGrid></VTKFile>
END
cat >pieces.pvtu <<'END'
<VTKFile type="PUnstructuredGrid" version="0.1"><PUnstructuredGrid><Piece Source="empty.vtu"/><Piece Source="good.vtu"/>
<Piece Source="empty.vtu"/></PUnstructuredGrid></VTKFile>
END
harmless pieces.pvtu
counts pieces.pvtu 'without volume +2, left out'
refuse 1 'holds no cells' render empty.vtu -o a.png
refuse 1 'holds no cells' info empty.vtu
vtu none.vtu '' 10
refuse 1 'holds no cells' render none.vtu -o a.png

# Warnings of other kinds, and meshes that are made.
refuse 1 '--background has no effect' render good.vtu -o b.exr --size 9x9 --background 0,0,0 --strict
refuse 1 'brute-force reference differ' converge overlap.vtu -o overlap --transfer t.json --size 40x30 --repeat 1 --no-plots --strict
echo '{"input": "value.vtu", "output": "s.png", "size": [9, 9], "strict": true}' >scene.json
refuse 1 'NaN' render --scene scene.json
cat >s.pvd <<'END'
<VTKFile type="Collection" version="0.1"><Collection><DataSet timestep="0" file="good.vtu"/><DataSet timestep="1" file="value.vtu"/>
</Collection></VTKFile>
END
refuse 1 'NaN' render s.pvd --time 1 --range series --size 9x9 -o b.png --strict
finish
