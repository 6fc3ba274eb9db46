# SPDX-License-Identifier: Apache-2.0
# command.sh COMMAND DRIVER SECONDS SEED [FILE…]: runs the driver (command.c) over files that are made here, and over
# those given. What it finds is copied to the folder $KEEP, if that is set.
driver=$(realpath "$2")
seconds=$3 seed=$4
given=()
for file in "${@:5}"; do given+=("$(realpath "$file")"); done
# shellcheck source=tests/cli/lib.sh
. "$(dirname "$0")/../cli/lib.sh"
needs vtk openimageio
vtu text.vtu "$five_tetrahedra" 10

# The same as text of numbers, base64 and bytes behind the rest; with strings, and with what VTK writes about arrays.
string='<DataArray type="String" Name="names" NumberOfTuples="2" format="ascii">97 98 0 99 0</DataArray>'
begin='<VTKFile type="UnstructuredGrid" version="1.0" byte_order="LittleEndian" header_type="UInt32"><UnstructuredGrid>'
cells='<Cells><DataArray type="Int32" Name="connectivity" format="ascii">0 1 2 3</DataArray>
<DataArray type="Int32" Name="offsets" format="ascii">4</DataArray>
<DataArray type="UInt8" Name="types" format="ascii">10</DataArray></Cells>'
points='<Points><DataArray type="Float32" NumberOfComponents="3" format="ascii">0 0 0 1 0 0 0 1 0 0 0 1</DataArray></Points>'
cat >mixed.vtu <<END
$begin<FieldData>$string</FieldData><Piece NumberOfPoints="4" NumberOfCells="1"><PointData Scalars="a">
<DataArray type="Int16" Name="a" NumberOfComponents="2" ComponentName0="u" ComponentName1="v"
 format="binary">EAAAAAEAAgADAAQABQAGAAcACAA=</DataArray>
<DataArray type="Float64" Name="b" format="appended" offset="0" RangeMin="1" RangeMax="2">
<InformationKey name="L2_NORM_RANGE" location="vtkDataArray" length="2"><Value index="0">0</Value>
<Value index="1">1</Value></InformationKey></DataArray>$string</PointData>$points$cells</Piece></UnstructuredGrid>
<AppendedData encoding="base64">_IAAAAAAAAAAAAAAAAAAAAAAA8D8AAAAAAAAAAAAAAAAAAABA</AppendedData></VTKFile>
END
{
  printf '%s' "$begin<Piece NumberOfPoints=\"4\" NumberOfCells=\"1\"><PointData>
<DataArray type=\"UInt8\" Name=\"a\" format=\"appended\" offset=\"0\"/>
</PointData>$points$cells</Piece></UnstructuredGrid><AppendedData encoding=\"raw\">_"
  printf '\004\000\000\000\001\002\003\004'
  printf '</AppendedData></VTKFile>'
} >raw.vtu
cat >image.vti <<END
<VTKFile type="ImageData" version="0.1" byte_order="LittleEndian">
<ImageData WholeExtent="0 2 0 1 0 1" Origin="0 0 0" Spacing="1 1 0.5">
<FieldData>$string</FieldData><Piece Extent="0 2 0 1 0 1"><PointData Scalars="s">
<DataArray type="UInt16" Name="s" format="ascii">0 1 2 3 4 5 6 7 8 9 10 11</DataArray>$string</PointData>
<CellData><DataArray type="Float32" Name="c" format="binary">CAAAAAAAgD8AAABA</DataArray></CellData></Piece>
</ImageData></VTKFile>
END
for file in *.vt?; do accept info "$file"; done
mkdir changed
if ! "$driver" "$tetcast" changed "$seconds" "$seed" ./*.vt? "${given[@]}"; then
  fail 'see above'
  [ -z "$KEEP" ] || cp changed/found-* "$KEEP"
fi
finish
