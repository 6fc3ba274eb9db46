! SPDX-License-Identifier: Apache-2.0
! tetcast for Fortran 2008: all of libtetcast's constants, structs and functions by their names in C, and below them some
! that make arrays, text and errors Fortran's own. What each is and does stands in the headers, include/tetcast/*.h; to read
! them here:
!
! * An object (a context, a mesh, a scene …) is a type(c_ptr), c_null_ptr where there is none.
! * A struct is a derived type of the same name. One that has a function tetcast_…_desc_default() must be made by it; where a
!   C program may give NULL for such a desc, give what the function returns.
! * Arrays have their first index where C has its last: vertices are 3 × n, tetrahedra 4 × m, pixels 4 × width × height.
!   What is referred to (TETCAST_BORROW, pixels of a frame, arrays in a desc) needs the attribute `target`.
! * Text goes in as "text" // c_null_char, and comes out as a type(c_ptr), of which tetcast_string() makes a string.
! It is one file, as whoever uses it compiles it with their own sources, and one module, as structs refer to each other.
!
! * tetcast_context_error() and tetcast_context_message() are missing, as they take arguments of any number and type.
module tetcast
  use, intrinsic :: iso_c_binding
  use, intrinsic :: iso_fortran_env, only: error_unit
  implicit none

  ! Whether a call succeeded, or why not.
  integer(c_int), parameter :: &
    tetcast_ok = 0, &
    tetcast_error_argument = 1, &
    tetcast_error_memory = 2, &
    tetcast_error_data = 3, &
    tetcast_error_limit = 4, &
    tetcast_error_io = 5, &
    tetcast_error_unsupported = 6, &
    tetcast_error_cancelled = 7, &
    tetcast_error_embree = 8, &
    tetcast_status_count = 9

  ! Kinds of messages.
  integer(c_int), parameter :: &
    tetcast_severity_error = 0, &
    tetcast_severity_warning = 1, &
    tetcast_severity_info = 2

  ! Types of numbers in arrays.
  integer(c_int), parameter :: &
    tetcast_type_none = 0, &
    tetcast_type_float32 = 1, &
    tetcast_type_float64 = 2, &
    tetcast_type_int32 = 3, &
    tetcast_type_uint32 = 4, &
    tetcast_type_int64 = 5, &
    tetcast_type_uint64 = 6

  ! What becomes of arrays handed in.
  integer(c_int), parameter :: &
    tetcast_copy = 0, &
    tetcast_borrow = 1

  ! What the values of a field belong to.
  integer(c_int), parameter :: &
    tetcast_point = 0, &
    tetcast_cell = 1, &
    tetcast_corner = 2

  ! Shapes of cells, by VTK's numbers.
  integer(c_int), parameter :: &
    tetcast_cell_tetrahedron = 10, &
    tetcast_cell_voxel = 11, &
    tetcast_cell_hexahedron = 12, &
    tetcast_cell_wedge = 13, &
    tetcast_cell_pyramid = 14, &
    tetcast_cell_pentagonal_prism = 15, &
    tetcast_cell_hexagonal_prism = 16, &
    tetcast_cell_polyhedron = 42, &
    tetcast_cell_quadratic_tetrahedron = 24, &
    tetcast_cell_quadratic_hexahedron = 25, &
    tetcast_cell_quadratic_wedge = 26, &
    tetcast_cell_quadratic_pyramid = 27, &
    tetcast_cell_triquadratic_hexahedron = 29, &
    tetcast_cell_quadratic_linear_wedge = 31, &
    tetcast_cell_biquadratic_quadratic_wedge = 32, &
    tetcast_cell_biquadratic_quadratic_hexahedron = 33, &
    tetcast_cell_triquadratic_pyramid = 37, &
    tetcast_cell_lagrange_tetrahedron = 71, &
    tetcast_cell_lagrange_hexahedron = 72, &
    tetcast_cell_lagrange_wedge = 73, &
    tetcast_cell_bezier_tetrahedron = 78, &
    tetcast_cell_bezier_hexahedron = 79, &
    tetcast_cell_bezier_wedge = 80

  ! How the cells that a ray crosses are found.
  integer(c_int), parameter :: &
    tetcast_traversal_shell = 0, &
    tetcast_traversal_faces = 1

  ! How opacity becomes extinction.
  integer(c_int), parameter :: &
    tetcast_opacity_unit_distance = 0, &
    tetcast_opacity_vtk_unstructured = 1, &
    tetcast_opacity_ospray = 2

  ! What colours of a preset are for.
  integer(c_int), parameter :: &
    tetcast_preset_none = 0, &
    tetcast_preset_sequential = 1, &
    tetcast_preset_diverging = 2, &
    tetcast_preset_categorical = 3

  ! How rays spread.
  integer(c_int), parameter :: &
    tetcast_perspective = 0, &
    tetcast_orthographic = 1

  ! What light falls on.
  integer(c_int), parameter :: &
    tetcast_shade_none = 0, &
    tetcast_shade_surfaces = 1, &
    tetcast_shade_volume = 2, &
    tetcast_shade_all = 3

  ! What is perpendicular to an isosurface.
  integer(c_int), parameter :: &
    tetcast_normals_smooth = 0, &
    tetcast_normals_flat = 1

  ! What is made of the scalar along a ray.
  integer(c_int), parameter :: &
    tetcast_blend_composite = 0, &
    tetcast_blend_maximum = 1, &
    tetcast_blend_minimum = 2, &
    tetcast_blend_average = 3, &
    tetcast_blend_additive = 4

  ! How light is integrated.
  integer(c_int), parameter :: &
    tetcast_integrator_exact = 0, &
    tetcast_integrator_midpoint = 1, &
    tetcast_integrator_trapezoid = 2, &
    tetcast_integrator_gauss = 3, &
    tetcast_integrator_table = 4

  ! Instruction sets.
  integer(c_int), parameter :: &
    tetcast_isa_auto = 0, &
    tetcast_isa_scalar = 1, &
    tetcast_isa_avx2 = 2, &
    tetcast_isa_avx512 = 3

  ! Channels of a frame, bits of a set.
  integer(c_int), parameter :: &
    tetcast_channel_error = 1, &
    tetcast_channel_radiance = 2, &
    tetcast_channel_optical_depth = 4, &
    tetcast_channel_transmittance = 8, &
    tetcast_channel_path_length = 16, &
    tetcast_channel_value = 32, &
    tetcast_channel_depth = 64, &
    tetcast_channel_cells = 128, &
    tetcast_channel_normal = 256

  ! The most that there may be.
  integer(c_int), parameter :: &
    tetcast_max_subdivision = 16, &
    tetcast_max_isosurfaces = 256, &
    tetcast_max_slices = 8, &
    tetcast_max_lights = 16, &
    tetcast_max_gauss = 16, &
    tetcast_max_groups = 256, &
    tetcast_max_rows = 64, &
    tetcast_max_bins = 65536

  ! Who is told how far long work has come: a procedure like tetcast_progress_function, by c_funloc().
  type, bind(c) :: TetcastProgress
    type(c_funptr) :: function = c_null_funptr
    type(c_ptr) :: user = c_null_ptr
  end type

  ! What a context is made from; `message` is a procedure like tetcast_message_function, by c_funloc().
  type, bind(c) :: TetcastContextDesc
    integer(c_int32_t) :: cookie
    integer(c_int) :: threads
    type(c_funptr) :: message
    type(c_ptr) :: message_user
    type(c_funptr) :: allocate
    type(c_funptr) :: release
    type(c_ptr) :: memory_user
  end type

  ! A view of tuples in memory: tetcast_array() makes one of a Fortran array. Left out, `stride` is 0: they are packed.
  type, bind(c) :: TetcastArray
    type(c_ptr) :: data = c_null_ptr
    integer(c_int) :: type = 0
    integer(c_int64_t) :: count = 0
    integer(c_int64_t) :: stride = 0
  end type

  ! What a mesh is made from; with index_base = 1 the tetrahedra count vertices as Fortran does.
  type, bind(c) :: TetcastMeshDesc
    integer(c_int32_t) :: cookie
    type(TetcastArray) :: vertices
    type(TetcastArray) :: tetrahedra
    integer(c_int) :: ownership
    integer(c_int) :: index_base
    type(TetcastArray) :: coordinates(3)
    type(c_ptr) :: hidden
    integer(c_int8_t) :: hidden_bits
  end type

  ! The health of a mesh.
  type, bind(c) :: TetcastMeshHealth
    integer(c_int64_t) :: boundary_faces
    integer(c_int64_t) :: nonmanifold_faces
    integer(c_int64_t) :: components
    integer(c_int64_t) :: degenerate_cells
    integer(c_int64_t) :: inverted_cells
    integer(c_int64_t) :: duplicate_cells
    integer(c_int64_t) :: unused_vertices
    integer(c_int64_t) :: coincident_vertices
    real(c_double) :: volume
    real(c_double) :: boundary_area
  end type

  ! What a field is made from.
  type, bind(c) :: TetcastFieldDesc
    integer(c_int32_t) :: cookie
    type(TetcastArray) :: values
    integer(c_int) :: association
    integer(c_int) :: ownership
  end type

  ! Cells that are to be cut into tetrahedra; they count vertices from 0.
  type, bind(c) :: TetcastCellsDesc
    integer(c_int32_t) :: cookie
    type(TetcastArray) :: vertices
    type(c_ptr) :: types
    integer(c_int) :: type
    type(TetcastArray) :: offsets
    type(TetcastArray) :: connectivity
    type(TetcastArray) :: faces
    type(TetcastArray) :: face_offsets
    type(TetcastArray) :: orders
    type(TetcastArray) :: rational
    type(c_ptr) :: hidden
    integer(c_int8_t) :: hidden_bits
    integer(c_int) :: subdivision
    logical(c_bool) :: sources
  end type

  ! What cutting has come to.
  type, bind(c) :: TetcastCutInfo
    integer(c_int64_t) :: cells
    integer(c_int64_t) :: tetrahedra
    integer(c_int64_t) :: added_vertices
    integer(c_int64_t) :: curved
    integer(c_int) :: segments(2)
    integer(c_int64_t) :: centred
    integer(c_int64_t) :: collapsed
    integer(c_int64_t) :: inverted
    integer(c_int64_t) :: folded
    integer(c_int64_t) :: open
    integer(c_int64_t) :: empty
    integer(c_int64_t) :: oversized
  end type

  ! How a volume is made; `bounds` is c_loc() of six numbers.
  type, bind(c) :: TetcastVolumeDesc
    integer(c_int32_t) :: cookie
    integer(c_int) :: traversal
    integer(c_int) :: corners
    type(c_ptr) :: bounds
    type(TetcastProgress) :: progress
  end type

  ! Describes a volume.
  type, bind(c) :: TetcastVolumeInfo
    integer(c_int64_t) :: vertices
    integer(c_int64_t) :: tetrahedra
    integer(c_int64_t) :: left_out
    integer(c_int64_t) :: welded
    integer(c_int64_t) :: shell_faces
    integer(c_size_t) :: bytes
    real(c_double) :: bounds(6)
    real(c_double) :: boundary_area
    integer(c_int) :: traversal
  end type

  ! What a transfer function is made from; knots are columns of arrays of 4 or 2 rows.
  type, bind(c) :: TetcastTransferFunctionDesc
    integer(c_int32_t) :: cookie
    type(c_ptr) :: color
    integer(c_int64_t) :: color_count
    type(c_ptr) :: extinction
    integer(c_int64_t) :: extinction_count
    type(c_ptr) :: opacity
    integer(c_int64_t) :: opacity_count
    real(c_double) :: unit_distance
    integer(c_int) :: opacity_model
  end type

  ! Where the picture is taken from.
  type, bind(c) :: TetcastCamera
    real(c_double) :: eye(3) = 0
    real(c_double) :: target(3) = 0
    real(c_double) :: up(3) = 0
    integer(c_int) :: projection = 0
    real(c_double) :: fovy = 0
    real(c_double) :: height = 0
    real(c_double) :: center(2) = 0
  end type

  ! What a clip keeps.
  type, bind(c) :: TetcastHalfSpace
    real(c_double) :: normal(3) = 0
    real(c_double) :: offset = 0
  end type

  ! An isosurface.
  type, bind(c) :: TetcastIsosurface
    real(c_double) :: value = 0
    real(c_double) :: color(3) = 0
    real(c_double) :: opacity = 0
  end type

  ! A plane through the mesh.
  type, bind(c) :: TetcastSlice
    real(c_double) :: normal(3) = 0
    real(c_double) :: offset = 0
    real(c_double) :: opacity = 0
  end type

  ! How the boundary of the mesh is seen.
  type, bind(c) :: TetcastBoundary
    real(c_double) :: opacity = 0
    integer(c_int) :: colored = 0
    real(c_double) :: color(3) = 0
    integer(c_int) :: edges = 0
    real(c_double) :: edge_color(3) = 0
  end type

  ! A light from one direction.
  type, bind(c) :: TetcastLight
    real(c_double) :: direction(3) = 0
    real(c_double) :: color(3) = 0
  end type

  ! How light is reflected.
  type, bind(c) :: TetcastShadingDesc
    integer(c_int32_t) :: cookie
    integer(c_int) :: shade
    integer(c_int) :: normals
    real(c_double) :: ambient
    real(c_double) :: diffuse
    real(c_double) :: specular
    real(c_double) :: exponent
    type(c_ptr) :: lights
    integer(c_int) :: light_count
    integer(c_int) :: shadows
    integer(c_int) :: occlusion_rays
  end type

  ! What a frame is made from; pixels are an array of 4 × width × height.
  type, bind(c) :: TetcastFrameDesc
    integer(c_int32_t) :: cookie
    integer(c_int64_t) :: width
    integer(c_int64_t) :: height
    integer(c_int) :: type
    type(c_ptr) :: pixels
    integer(c_int64_t) :: row_stride
    integer(c_int32_t) :: channels
    integer(c_int) :: groups
  end type

  ! Describes a channel.
  type, bind(c) :: TetcastChannelInfo
    integer(c_int) :: channel
    type(c_ptr) :: name
    type(c_ptr) :: file_name
    type(c_ptr) :: description
    integer(c_int) :: components
    integer(c_int) :: of_groups
    integer(c_int) :: needs_coefficients
    integer(c_int) :: needs_composite
    integer(c_int) :: needs_blend
  end type

  ! A row of a transfer function of two dimensions.
  type, bind(c) :: TetcastTransferRow
    real(c_double) :: at = 0
    type(c_ptr) :: transfer_function = c_null_ptr
  end type

  ! Extinction and emission as they are; both are c_loc() of an array of fields, each a type(c_ptr).
  type, bind(c) :: TetcastCoefficientsDesc
    integer(c_int32_t) :: cookie
    type(c_ptr) :: extinction
    type(c_ptr) :: emission
    integer(c_int) :: extinction_count
    integer(c_int) :: emission_count
    type(c_ptr) :: extinction_name
    type(c_ptr) :: emission_name
  end type

  ! How a picture is computed.
  type, bind(c) :: TetcastRenderDesc
    integer(c_int32_t) :: cookie
    integer(c_int) :: integrator
    integer(c_int) :: integrator_n
    integer(c_int) :: samples
    integer(c_int) :: isa
    real(c_double) :: tolerance
    type(c_ptr) :: stop
    type(c_ptr) :: start
    integer(c_int64_t) :: picture_height
    integer(c_int64_t) :: first_row
    integer(c_int) :: adaptive_coarse
    real(c_double) :: adaptive_epsilon
    integer(c_int) :: adaptive_fine
    type(TetcastProgress) :: progress
  end type

  ! What was done to make a picture.
  type, bind(c) :: TetcastRenderStats
    integer(c_int64_t) :: rays
    integer(c_int64_t) :: segments
    real(c_double) :: error
    integer(c_int64_t) :: lost
    type(c_ptr) :: isa
    type(c_ptr) :: precision
  end type

  ! Any rays, made by tetcast_rays_default(): origins and directions are arrays of 3 × n, begins and ends of n.
  type, bind(c) :: TetcastRays
    integer(c_int32_t) :: cookie
    type(TetcastArray) :: origins
    type(TetcastArray) :: directions
    type(TetcastArray) :: begins
    type(TetcastArray) :: ends
  end type

  ! Where the results of rays go: c_loc() of arrays of real(c_double), 4 × n, n or groups × n. Left out: not wanted.
  type, bind(c) :: TetcastCastResult
    type(c_ptr) :: color = c_null_ptr
    type(c_ptr) :: optical_depth = c_null_ptr
    type(c_ptr) :: length = c_null_ptr
    type(c_ptr) :: error = c_null_ptr
    type(c_ptr) :: value = c_null_ptr
    type(c_ptr) :: radiance = c_null_ptr
    type(c_ptr) :: group_optical_depth = c_null_ptr
    type(c_ptr) :: transmittance = c_null_ptr
  end type

  ! How rays are cast.
  type, bind(c) :: TetcastCastDesc
    integer(c_int32_t) :: cookie
    integer(c_int) :: isa
    type(TetcastProgress) :: progress
  end type

  ! A cell that a ray crosses; cell and vertices are counted from 0.
  type, bind(c) :: TetcastCrossing
    integer(c_int32_t) :: cell
    integer(c_int32_t) :: vertex(4)
    real(c_double) :: begin
    real(c_double) :: end
    real(c_double) :: length
    real(c_double) :: weight(4, 2)
  end type

  ! What several rays cross, all counted from 0: c_f_pointer() makes Fortran pointers of the last two.
  type, bind(c) :: TetcastTrace
    integer(c_int64_t) :: first
    integer(c_int64_t) :: count
    type(c_ptr) :: offsets
    type(c_ptr) :: crossings
  end type

  ! How rays are traced.
  type, bind(c) :: TetcastTraceDesc
    integer(c_int32_t) :: cookie
    integer(c_int) :: weights
    integer(c_int) :: isa
    type(TetcastProgress) :: progress
  end type

  ! What a ray has in a part of a mesh; pixels are counted from 0.
  type, bind(c) :: TetcastFragment
    integer(c_int64_t) :: pixel
    real(c_double) :: begin
    real(c_double) :: end
    real(c_double) :: optical_depth
    real(c_double) :: color(3)
  end type

  ! Some fragments; `data` is c_loc() of an array of them, `groups` of an array (2, group_count, count).
  type, bind(c) :: TetcastFragmentList
    type(c_ptr) :: data = c_null_ptr
    integer(c_int64_t) :: count = 0
    type(c_ptr) :: groups = c_null_ptr
    integer(c_int) :: group_count = 0
  end type

  ! What is to be found out about a field.
  type, bind(c) :: TetcastStatisticsDesc
    integer(c_int32_t) :: cookie
    real(c_double) :: range(2)
    integer(c_int) :: bins
    real(c_double) :: gradient_range(2)
    integer(c_int) :: gradient_bins
  end type

  ! How a field's values are distributed: c_f_pointer() makes Fortran pointers of the last four.
  type, bind(c) :: TetcastStatistics
    real(c_double) :: range(2)
    integer(c_int) :: bins
    real(c_double) :: gradient_range(2)
    integer(c_int) :: gradient_bins
    real(c_double) :: total
    real(c_double) :: unknown
    real(c_double) :: below
    real(c_double) :: above
    type(c_ptr) :: volume
    type(c_ptr) :: area
    type(c_ptr) :: gradient
    type(c_ptr) :: joint
  end type

  ! What C calls back must be procedures of these forms, handed over by c_funloc(); with bind(c), in a module or external.
  abstract interface
    subroutine tetcast_message_function(user, severity, text) bind(c)
      import
      type(c_ptr), value :: user
      integer(c_int), value :: severity
      type(c_ptr), value :: text
    end subroutine

    function tetcast_progress_function(user, fraction) result(goes_on) bind(c)
      import
      type(c_ptr), value :: user
      real(c_double), value :: fraction
      logical(c_bool) :: goes_on
    end function

    function tetcast_allocate_function(user, size, alignment) result(memory) bind(c)
      import
      type(c_ptr), value :: user
      integer(c_size_t), value :: size, alignment
      type(c_ptr) :: memory
    end function

    subroutine tetcast_release_function(user, memory) bind(c)
      import
      type(c_ptr), value :: user, memory
    end subroutine

    function tetcast_trace_function(user, trace) result(goes_on) bind(c)
      import
      type(c_ptr), value :: user
      type(TetcastTrace), intent(in) :: trace
      logical(c_bool) :: goes_on
    end function
  end interface

  interface
    ! status.h: whether a call succeeded
    function tetcast_status_string(status) result(answer) bind(c)
      import
      integer(c_int), value :: status
      type(c_ptr) :: answer
    end function

    ! version.h: versions
    function tetcast_version_string() result(answer) bind(c)
      import
      type(c_ptr) :: answer
    end function

    function tetcast_embree_version_string() result(answer) bind(c)
      import
      type(c_ptr) :: answer
    end function

    ! context.h: what objects share
    function tetcast_context_desc_default() result(answer) bind(c)
      import
      type(TetcastContextDesc) :: answer
    end function

    function tetcast_context_create(desc, context) result(status) bind(c)
      import
      type(TetcastContextDesc), intent(in) :: desc
      type(c_ptr), intent(out) :: context
      integer(c_int) :: status
    end function

    subroutine tetcast_context_destroy(context) bind(c)
      import
      type(c_ptr), intent(inout) :: context
    end subroutine

    function tetcast_context_set_threads(context, threads) result(status) bind(c)
      import
      type(c_ptr), value :: context
      integer(c_int), value :: threads
      integer(c_int) :: status
    end function

    function tetcast_context_threads(context) result(answer) bind(c)
      import
      type(c_ptr), value :: context
      integer(c_int) :: answer
    end function

    ! mesh.h: vertices and tetrahedra
    function tetcast_mesh_desc_default() result(answer) bind(c)
      import
      type(TetcastMeshDesc) :: answer
    end function

    function tetcast_mesh_create(context, desc, mesh) result(status) bind(c)
      import
      type(c_ptr), value :: context
      type(TetcastMeshDesc), intent(in) :: desc
      type(c_ptr), intent(out) :: mesh
      integer(c_int) :: status
    end function

    subroutine tetcast_mesh_destroy(mesh) bind(c)
      import
      type(c_ptr), intent(inout) :: mesh
    end subroutine

    function tetcast_mesh_vertex_count(mesh) result(answer) bind(c)
      import
      type(c_ptr), value :: mesh
      integer(c_int64_t) :: answer
    end function

    function tetcast_mesh_tetrahedron_count(mesh) result(answer) bind(c)
      import
      type(c_ptr), value :: mesh
      integer(c_int64_t) :: answer
    end function

    function tetcast_mesh_vertices(mesh) result(answer) bind(c)
      import
      type(c_ptr), value :: mesh
      type(TetcastArray) :: answer
    end function

    function tetcast_mesh_tetrahedra(mesh) result(answer) bind(c)
      import
      type(c_ptr), value :: mesh
      type(TetcastArray) :: answer
    end function

    function tetcast_mesh_index_base(mesh) result(answer) bind(c)
      import
      type(c_ptr), value :: mesh
      integer(c_int) :: answer
    end function

    subroutine tetcast_mesh_vertex(mesh, i, position) bind(c)
      import
      type(c_ptr), value :: mesh
      integer(c_int64_t), value :: i
      real(c_double), intent(out) :: position(3)
    end subroutine

    subroutine tetcast_mesh_tetrahedron(mesh, i, indices) bind(c)
      import
      type(c_ptr), value :: mesh
      integer(c_int64_t), value :: i
      integer(c_int64_t), intent(out) :: indices(4)
    end subroutine

    function tetcast_mesh_hides(mesh, i) result(answer) bind(c)
      import
      type(c_ptr), value :: mesh
      integer(c_int64_t), value :: i
      integer(c_int) :: answer
    end function

    subroutine tetcast_mesh_bounds(mesh, bounds) bind(c)
      import
      type(c_ptr), value :: mesh
      real(c_double), intent(out) :: bounds(6)
    end subroutine

    function tetcast_mesh_health(context, mesh, health) result(status) bind(c)
      import
      type(c_ptr), value :: context, mesh
      type(TetcastMeshHealth), intent(out) :: health
      integer(c_int) :: status
    end function

    ! field.h: scalars on a mesh
    function tetcast_field_desc_default() result(answer) bind(c)
      import
      type(TetcastFieldDesc) :: answer
    end function

    function tetcast_field_create(context, desc, field) result(status) bind(c)
      import
      type(c_ptr), value :: context
      type(TetcastFieldDesc), intent(in) :: desc
      type(c_ptr), intent(out) :: field
      integer(c_int) :: status
    end function

    subroutine tetcast_field_destroy(field) bind(c)
      import
      type(c_ptr), intent(inout) :: field
    end subroutine

    function tetcast_field_association(field) result(answer) bind(c)
      import
      type(c_ptr), value :: field
      integer(c_int) :: answer
    end function

    function tetcast_field_values(field) result(answer) bind(c)
      import
      type(c_ptr), value :: field
      type(TetcastArray) :: answer
    end function

    function tetcast_field_value(field, i) result(answer) bind(c)
      import
      type(c_ptr), value :: field
      integer(c_int64_t), value :: i
      real(c_double) :: answer
    end function

    subroutine tetcast_field_range(field, range, nonfinite_count) bind(c)
      import
      type(c_ptr), value :: field
      real(c_double), intent(out) :: range(2)
      integer(c_int64_t), intent(out) :: nonfinite_count
    end subroutine

    ! cells.h: cells of other shapes, cut into tetrahedra
    function tetcast_cells_desc_default() result(answer) bind(c)
      import
      type(TetcastCellsDesc) :: answer
    end function

    function tetcast_cells_cut(context, desc, cut) result(status) bind(c)
      import
      type(c_ptr), value :: context
      type(TetcastCellsDesc), intent(in) :: desc
      type(c_ptr), intent(out) :: cut
      integer(c_int) :: status
    end function

    subroutine tetcast_cut_destroy(cut) bind(c)
      import
      type(c_ptr), intent(inout) :: cut
    end subroutine

    function tetcast_cut_tetrahedra(cut) result(answer) bind(c)
      import
      type(c_ptr), value :: cut
      type(TetcastArray) :: answer
    end function

    function tetcast_cut_sources(cut) result(answer) bind(c)
      import
      type(c_ptr), value :: cut
      type(TetcastArray) :: answer
    end function

    function tetcast_cut_interpolate(cut, values, components, result) result(answer) bind(c)
      import
      type(c_ptr), value :: cut
      type(TetcastArray), intent(in) :: values
      integer(c_int), value :: components
      real(c_double), intent(out) :: result(*)
      logical(c_bool) :: answer
    end function

    subroutine tetcast_cut_info(cut, info) bind(c)
      import
      type(c_ptr), value :: cut
      type(TetcastCutInfo), intent(out) :: info
    end subroutine

    ! volume.h: a mesh prepared for rays
    function tetcast_volume_desc_default() result(answer) bind(c)
      import
      type(TetcastVolumeDesc) :: answer
    end function

    function tetcast_volume_create(context, mesh, desc, volume) result(status) bind(c)
      import
      type(c_ptr), value :: context, mesh
      type(TetcastVolumeDesc), intent(in) :: desc
      type(c_ptr), intent(out) :: volume
      integer(c_int) :: status
    end function

    subroutine tetcast_volume_destroy(volume) bind(c)
      import
      type(c_ptr), intent(inout) :: volume
    end subroutine

    subroutine tetcast_volume_info(volume, info) bind(c)
      import
      type(c_ptr), value :: volume
      type(TetcastVolumeInfo), intent(out) :: info
    end subroutine

    ! transfer_function.h: colour and extinction of a scalar
    function tetcast_transfer_function_desc_default() result(answer) bind(c)
      import
      type(TetcastTransferFunctionDesc) :: answer
    end function

    function tetcast_transfer_function_create(context, desc, transfer_function) result(status) bind(c)
      import
      type(c_ptr), value :: context
      type(TetcastTransferFunctionDesc), intent(in) :: desc
      type(c_ptr), intent(out) :: transfer_function
      integer(c_int) :: status
    end function

    function tetcast_preset_name(i) result(answer) bind(c)
      import
      integer(c_int), value :: i
      type(c_ptr) :: answer
    end function

    function tetcast_preset_kind(name) result(answer) bind(c)
      import
      character(kind=c_char), intent(in) :: name(*)
      integer(c_int) :: answer
    end function

    function tetcast_transfer_function_create_preset(context, name, low, high, extinction, transfer_function) &
      result(status) bind(c)
      import
      type(c_ptr), value :: context
      character(kind=c_char), intent(in) :: name(*)
      real(c_double), value :: low, high, extinction
      type(c_ptr), intent(out) :: transfer_function
      integer(c_int) :: status
    end function

    function tetcast_transfer_function_stretch(context, shape, low, high, extinction, transfer_function) &
      result(status) bind(c)
      import
      type(c_ptr), value :: context, shape
      real(c_double), value :: low, high, extinction
      type(c_ptr), intent(out) :: transfer_function
      integer(c_int) :: status
    end function

    function tetcast_opacity_factor(context, depths, count, opacity, clear, factor) result(status) bind(c)
      import
      type(c_ptr), value :: context
      real(c_double), intent(in) :: depths(*)
      integer(c_int64_t), value :: count
      real(c_double), value :: opacity
      integer(c_int), value :: clear
      real(c_double), intent(out) :: factor
      integer(c_int) :: status
    end function

    subroutine tetcast_transfer_function_destroy(transfer_function) bind(c)
      import
      type(c_ptr), intent(inout) :: transfer_function
    end subroutine

    function tetcast_transfer_function_color(transfer_function, count) result(answer) bind(c)
      import
      type(c_ptr), value :: transfer_function
      integer(c_int64_t), intent(out) :: count
      type(c_ptr) :: answer
    end function

    function tetcast_transfer_function_extinction(transfer_function, count) result(answer) bind(c)
      import
      type(c_ptr), value :: transfer_function
      integer(c_int64_t), intent(out) :: count
      type(c_ptr) :: answer
    end function

    ! camera.h: cameras
    function tetcast_camera_default(bounds, aspect) result(answer) bind(c)
      import
      real(c_double), intent(in) :: bounds(6)
      real(c_double), value :: aspect
      type(TetcastCamera) :: answer
    end function

    ! shading.h: light
    function tetcast_shading_desc_default() result(answer) bind(c)
      import
      type(TetcastShadingDesc) :: answer
    end function

    ! frame.h: pictures in memory
    function tetcast_channel_info(i) result(answer) bind(c)
      import
      integer(c_int), value :: i
      type(c_ptr) :: answer
    end function

    function tetcast_frame_desc_default() result(answer) bind(c)
      import
      type(TetcastFrameDesc) :: answer
    end function

    function tetcast_frame_create(context, desc, frame) result(status) bind(c)
      import
      type(c_ptr), value :: context
      type(TetcastFrameDesc), intent(in) :: desc
      type(c_ptr), intent(out) :: frame
      integer(c_int) :: status
    end function

    subroutine tetcast_frame_destroy(frame) bind(c)
      import
      type(c_ptr), intent(inout) :: frame
    end subroutine

    function tetcast_frame_width(frame) result(answer) bind(c)
      import
      type(c_ptr), value :: frame
      integer(c_int64_t) :: answer
    end function

    function tetcast_frame_height(frame) result(answer) bind(c)
      import
      type(c_ptr), value :: frame
      integer(c_int64_t) :: answer
    end function

    function tetcast_frame_type(frame) result(answer) bind(c)
      import
      type(c_ptr), value :: frame
      integer(c_int) :: answer
    end function

    function tetcast_frame_pixels(frame) result(answer) bind(c)
      import
      type(c_ptr), value :: frame
      type(c_ptr) :: answer
    end function

    function tetcast_frame_row_stride(frame) result(answer) bind(c)
      import
      type(c_ptr), value :: frame
      integer(c_int64_t) :: answer
    end function

    function tetcast_frame_groups(frame) result(answer) bind(c)
      import
      type(c_ptr), value :: frame
      integer(c_int) :: answer
    end function

    function tetcast_frame_channel(frame, channel) result(answer) bind(c)
      import
      type(c_ptr), value :: frame
      integer(c_int), value :: channel
      type(c_ptr) :: answer
    end function

    function tetcast_frame_recolor(frame, transfer_function) result(status) bind(c)
      import
      type(c_ptr), value :: frame, transfer_function
      integer(c_int) :: status
    end function

    ! `bytes` is c_loc() of the first of them.
    function tetcast_frame_bytes(frame, background, channels, bytes, row_stride) result(status) bind(c)
      import
      type(c_ptr), value :: frame, bytes
      real(c_double), intent(in) :: background(4)
      integer(c_int), value :: channels
      integer(c_int64_t), value :: row_stride
      integer(c_int) :: status
    end function

    ! scene.h: what is seen, and rendering it
    function tetcast_scene_create(context, volume, scene) result(status) bind(c)
      import
      type(c_ptr), value :: context, volume
      type(c_ptr), intent(out) :: scene
      integer(c_int) :: status
    end function

    subroutine tetcast_scene_destroy(scene) bind(c)
      import
      type(c_ptr), intent(inout) :: scene
    end subroutine

    function tetcast_scene_set_field(scene, field) result(status) bind(c)
      import
      type(c_ptr), value :: scene, field
      integer(c_int) :: status
    end function

    function tetcast_scene_share_field(scene, other) result(status) bind(c)
      import
      type(c_ptr), value :: scene, other
      integer(c_int) :: status
    end function

    function tetcast_scene_create_preset(scene, name, low, high, transfer_function) result(status) bind(c)
      import
      type(c_ptr), value :: scene
      character(kind=c_char), intent(in) :: name(*)
      real(c_double), value :: low, high
      type(c_ptr), intent(out) :: transfer_function
      integer(c_int) :: status
    end function

    function tetcast_scene_scale_transfer_function(scene, shape, camera, opacity, transfer_function) &
      result(status) bind(c)
      import
      type(c_ptr), value :: scene, shape
      type(TetcastCamera), intent(in) :: camera
      real(c_double), value :: opacity
      type(c_ptr), intent(out) :: transfer_function
      integer(c_int) :: status
    end function

    function tetcast_scene_fit_transfer_function(scene, shape, low, high, transfer_function) result(status) bind(c)
      import
      type(c_ptr), value :: scene, shape
      real(c_double), value :: low, high
      type(c_ptr), intent(out) :: transfer_function
      integer(c_int) :: status
    end function

    function tetcast_scene_set_transfer_function(scene, transfer_function) result(status) bind(c)
      import
      type(c_ptr), value :: scene, transfer_function
      integer(c_int) :: status
    end function

    function tetcast_scene_set_transfer_rows(scene, rows, count, second) result(status) bind(c)
      import
      type(c_ptr), value :: scene
      type(TetcastTransferRow), intent(in) :: rows(*)
      integer(c_int), value :: count
      type(c_ptr), value :: second
      integer(c_int) :: status
    end function

    function tetcast_scene_set_blend(scene, blend) result(status) bind(c)
      import
      type(c_ptr), value :: scene
      integer(c_int), value :: blend
      integer(c_int) :: status
    end function

    function tetcast_scene_blend(scene) result(answer) bind(c)
      import
      type(c_ptr), value :: scene
      integer(c_int) :: answer
    end function

    function tetcast_scene_set_isosurfaces(scene, isosurfaces, count) result(status) bind(c)
      import
      type(c_ptr), value :: scene
      type(TetcastIsosurface), intent(in) :: isosurfaces(*)
      integer(c_int), value :: count
      integer(c_int) :: status
    end function

    function tetcast_scene_set_slices(scene, slices, count) result(status) bind(c)
      import
      type(c_ptr), value :: scene
      type(TetcastSlice), intent(in) :: slices(*)
      integer(c_int), value :: count
      integer(c_int) :: status
    end function

    function tetcast_scene_set_boundary(scene, boundary) result(status) bind(c)
      import
      type(c_ptr), value :: scene
      type(TetcastBoundary), intent(in) :: boundary
      integer(c_int) :: status
    end function

    function tetcast_scene_set_shading(scene, desc) result(status) bind(c)
      import
      type(c_ptr), value :: scene
      type(TetcastShadingDesc), intent(in) :: desc
      integer(c_int) :: status
    end function

    function tetcast_scene_set_clip(scene, half_spaces, count) result(status) bind(c)
      import
      type(c_ptr), value :: scene
      type(TetcastHalfSpace), intent(in) :: half_spaces(*)
      integer(c_int), value :: count
      integer(c_int) :: status
    end function

    function tetcast_coefficients_desc_default() result(answer) bind(c)
      import
      type(TetcastCoefficientsDesc) :: answer
    end function

    function tetcast_scene_set_coefficients(scene, desc) result(status) bind(c)
      import
      type(c_ptr), value :: scene
      type(TetcastCoefficientsDesc), intent(in) :: desc
      integer(c_int) :: status
    end function

    function tetcast_scene_groups(scene) result(answer) bind(c)
      import
      type(c_ptr), value :: scene
      integer(c_int) :: answer
    end function

    function tetcast_scene_look(scene) result(answer) bind(c)
      import
      type(c_ptr), value :: scene
      integer(c_int64_t) :: answer
    end function

    function tetcast_render_desc_default() result(answer) bind(c)
      import
      type(TetcastRenderDesc) :: answer
    end function

    function tetcast_scene_render(scene, camera, desc, frame, stats) result(status) bind(c)
      import
      type(c_ptr), value :: scene
      type(TetcastCamera), intent(in) :: camera
      type(TetcastRenderDesc), intent(in) :: desc
      type(c_ptr), value :: frame
      type(TetcastRenderStats), intent(out) :: stats
      integer(c_int) :: status
    end function

    function tetcast_scene_draw_outline(scene, camera, desc, color, frame) result(status) bind(c)
      import
      type(c_ptr), value :: scene
      type(TetcastCamera), intent(in) :: camera
      type(TetcastRenderDesc), intent(in) :: desc
      real(c_double), intent(in) :: color(3)
      type(c_ptr), value :: frame
      integer(c_int) :: status
    end function

    ! cast.h: rays as numbers
    function tetcast_rays_default() result(answer) bind(c)
      import
      type(TetcastRays) :: answer
    end function

    function tetcast_cast_desc_default() result(answer) bind(c)
      import
      type(TetcastCastDesc) :: answer
    end function

    function tetcast_scene_cast(scene, rays, desc, result, stats) result(status) bind(c)
      import
      type(c_ptr), value :: scene
      type(TetcastRays), intent(in) :: rays
      type(TetcastCastDesc), intent(in) :: desc
      type(TetcastCastResult), intent(in) :: result
      type(TetcastRenderStats), intent(out) :: stats
      integer(c_int) :: status
    end function

    function tetcast_trace_desc_default() result(answer) bind(c)
      import
      type(TetcastTraceDesc) :: answer
    end function

    function tetcast_volume_trace(volume, rays, desc, function, user) result(status) bind(c)
      import
      type(c_ptr), value :: volume
      type(TetcastRays), intent(in) :: rays
      type(TetcastTraceDesc), intent(in) :: desc
      type(c_funptr), value :: function
      type(c_ptr), value :: user
      integer(c_int) :: status
    end function

    ! fragments.h: parts of a mesh
    function tetcast_fragments_create(context, fragments) result(status) bind(c)
      import
      type(c_ptr), value :: context
      type(c_ptr), intent(out) :: fragments
      integer(c_int) :: status
    end function

    subroutine tetcast_fragments_destroy(fragments) bind(c)
      import
      type(c_ptr), intent(inout) :: fragments
    end subroutine

    function tetcast_fragments_list(fragments) result(answer) bind(c)
      import
      type(c_ptr), value :: fragments
      type(TetcastFragmentList) :: answer
    end function

    function tetcast_scene_render_fragments(scene, camera, desc, width, height, fragments, stats) result(status) bind(c)
      import
      type(c_ptr), value :: scene
      type(TetcastCamera), intent(in) :: camera
      type(TetcastRenderDesc), intent(in) :: desc
      integer(c_int64_t), value :: width, height
      type(c_ptr), value :: fragments
      type(TetcastRenderStats), intent(out) :: stats
      integer(c_int) :: status
    end function

    function tetcast_fragments_composite(context, lists, count, frame, overlap) result(status) bind(c)
      import
      type(c_ptr), value :: context
      type(TetcastFragmentList), intent(in) :: lists(*)
      integer(c_int64_t), value :: count
      type(c_ptr), value :: frame
      real(c_double), intent(out) :: overlap
      integer(c_int) :: status
    end function

    ! statistics.h: the distribution of values
    function tetcast_statistics_desc_default() result(answer) bind(c)
      import
      type(TetcastStatisticsDesc) :: answer
    end function

    function tetcast_statistics_create(context, mesh, field, desc, statistics) result(status) bind(c)
      import
      type(c_ptr), value :: context, mesh, field
      type(TetcastStatisticsDesc), intent(in) :: desc
      type(c_ptr), intent(out) :: statistics
      integer(c_int) :: status
    end function

    subroutine tetcast_statistics_destroy(context, statistics) bind(c)
      import
      type(c_ptr), value :: context
      type(c_ptr), intent(inout) :: statistics
    end subroutine

    function tetcast_statistics_quantiles(context, mesh, field, shares, count, values) result(status) bind(c)
      import
      type(c_ptr), value :: context, mesh, field
      real(c_double), intent(in) :: shares(*)
      integer(c_int), value :: count
      real(c_double), intent(out) :: values(*)
      integer(c_int) :: status
    end function
  end interface

  ! ── beyond the C library ──

  ! tetcast_array(values): a view of an array for a desc, nothing copied: real or integer of 4 or 8 bytes, of rank 1 (one
  ! number a tuple) or 2 (a tuple a column). It may be a section such as x(1:3, ::2), but not one with gaps within a column:
  ! of such an array it is a view of no type, which is refused wherever it is given. The array must be a `target`, and must
  ! stay as long as the view is used.
  interface tetcast_array
    module procedure array_float32, array_float64, array_int32, array_int64
    module procedure array_float32_columns, array_float64_columns, array_int32_columns, array_int64_columns
  end interface

  ! tetcast_make_mesh(context, vertices, tetrahedra, mesh): a mesh of tetrahedra (4 × m) that count vertices from 1, copied
  ! unless told otherwise by `ownership`. Vertices are one view (3 × n) or [x, y, z], three views of n numbers:
  ! tetcast_make_mesh(context, [tetcast_array(x), tetcast_array(y), tetcast_array(z)], tetcast_array(cells), mesh).
  ! `hidden` has m numbers, next to each other, of the ownership of the others: cells whose number has any of `hidden_bits`
  ! are left out, by default those whose number isn't 0.
  interface tetcast_make_mesh
    module procedure mesh_of_vertices, mesh_of_coordinates
  end interface

  private :: array_float32, array_float64, array_int32, array_int64
  private :: array_float32_columns, array_float64_columns, array_int32_columns, array_int64_columns
  private :: mesh_of_vertices, mesh_of_coordinates, mesh_of, view_of, bytes_between, error_unit

contains

  ! ── text and errors ──

  ! A copy of a C string; empty for c_null_ptr.
  function tetcast_string(text) result(string)
    type(c_ptr), intent(in) :: text
    character(len=:), allocatable :: string
    character(kind=c_char), pointer :: characters(:)
    integer :: length, i
    interface
      function c_length(text) result(length) bind(c, name='strlen')
        import
        type(c_ptr), value :: text
        integer(c_size_t) :: length
      end function
    end interface
    length = 0
    if (c_associated(text)) length = int(c_length(text))
    allocate (character(len=length) :: string)
    if (length == 0) return
    call c_f_pointer(text, characters, [length])
    do i = 1, length
      string(i:i) = characters(i)
    end do
  end function

  ! A procedure for messages: desc%message = c_funloc(tetcast_print_message) sends them to the standard error, behind
  ! "tetcast: ", or behind the C string that desc%message_user points to.
  subroutine tetcast_print_message(user, severity, text) bind(c)
    type(c_ptr), value :: user
    integer(c_int), value :: severity
    type(c_ptr), value :: text
    character(len=:), allocatable :: front
    front = 'tetcast: '
    if (c_associated(user)) front = tetcast_string(user)
    if (severity == tetcast_severity_warning) front = front // 'warning: '
    write (error_unit, '(2a)') front, tetcast_string(text)
  end subroutine

  ! Ends the program with the status' phrase on the standard error unless the status is TETCAST_OK.
  subroutine tetcast_check(status)
    integer(c_int), intent(in) :: status
    if (status == tetcast_ok) return
    write (error_unit, '(2a)') 'tetcast: ', tetcast_string(tetcast_status_string(status))
    error stop 1
  end subroutine

  ! ── objects from arrays ──

  function mesh_of_vertices(context, vertices, tetrahedra, mesh, ownership, hidden, hidden_bits) result(status)
    type(c_ptr), intent(in) :: context
    type(TetcastArray), intent(in) :: vertices, tetrahedra
    type(c_ptr), intent(out) :: mesh
    integer(c_int), intent(in), optional :: ownership
    integer(c_int8_t), intent(in), target, optional :: hidden(:)
    integer(c_int8_t), intent(in), optional :: hidden_bits
    integer(c_int) :: status
    type(TetcastMeshDesc) :: desc
    desc = tetcast_mesh_desc_default()
    desc%vertices = vertices
    status = mesh_of(context, desc, tetrahedra, mesh, ownership, hidden, hidden_bits)
  end function

  function mesh_of_coordinates(context, coordinates, tetrahedra, mesh, ownership, hidden, hidden_bits) result(status)
    type(c_ptr), intent(in) :: context
    type(TetcastArray), intent(in) :: coordinates(3), tetrahedra
    type(c_ptr), intent(out) :: mesh
    integer(c_int), intent(in), optional :: ownership
    integer(c_int8_t), intent(in), target, optional :: hidden(:)
    integer(c_int8_t), intent(in), optional :: hidden_bits
    integer(c_int) :: status
    type(TetcastMeshDesc) :: desc
    desc = tetcast_mesh_desc_default()
    desc%coordinates = coordinates
    status = mesh_of(context, desc, tetrahedra, mesh, ownership, hidden, hidden_bits)
  end function

  ! The mesh of a desc that has the vertices.
  function mesh_of(context, desc, tetrahedra, mesh, ownership, hidden, hidden_bits) result(status)
    type(c_ptr), intent(in) :: context
    type(TetcastMeshDesc), intent(inout) :: desc
    type(TetcastArray), intent(in) :: tetrahedra
    type(c_ptr), intent(out) :: mesh
    integer(c_int), intent(in), optional :: ownership
    integer(c_int8_t), intent(in), target, optional :: hidden(:)
    integer(c_int8_t), intent(in), optional :: hidden_bits
    integer(c_int) :: status
    mesh = c_null_ptr
    desc%tetrahedra = tetrahedra
    desc%index_base = 1
    if (present(ownership)) desc%ownership = ownership
    if (present(hidden)) then
      status = tetcast_error_argument
      if (size(hidden, 1, c_int64_t) /= tetrahedra%count) return
      if (size(hidden) > 1) then
        if (bytes_between(c_loc(hidden(1)), c_loc(hidden(2))) /= 1) return
      end if
      if (size(hidden) > 0) then
        desc%hidden = c_loc(hidden(1))
        desc%hidden_bits = -1 ! all of them
        if (present(hidden_bits)) desc%hidden_bits = hidden_bits
      end if
    end if
    status = tetcast_mesh_create(context, desc, mesh)
  end function

  ! A field of values of points, or of what `association` says, copied unless told otherwise:
  ! tetcast_make_field(context, tetcast_array(u), field).
  function tetcast_make_field(context, values, field, association, ownership) result(status)
    type(c_ptr), intent(in) :: context
    type(TetcastArray), intent(in) :: values
    type(c_ptr), intent(out) :: field
    integer(c_int), intent(in), optional :: association, ownership
    integer(c_int) :: status
    type(TetcastFieldDesc) :: desc
    desc = tetcast_field_desc_default()
    desc%values = values
    if (present(association)) desc%association = association
    if (present(ownership)) desc%ownership = ownership
    status = tetcast_field_create(context, desc, field)
  end function

  ! A transfer function of knots: columns of a value and red, green, blue, and of a value and an extinction.
  function tetcast_make_transfer_function(context, color, extinction, transfer_function) result(status)
    type(c_ptr), intent(in) :: context
    real(c_double), intent(in), target, contiguous :: color(:, :), extinction(:, :)
    type(c_ptr), intent(out) :: transfer_function
    integer(c_int) :: status
    type(TetcastTransferFunctionDesc) :: desc
    transfer_function = c_null_ptr
    status = tetcast_error_argument
    if (size(color, 1) /= 4 .or. size(extinction, 1) /= 2 .or. size(color) * size(extinction) == 0) return
    desc = tetcast_transfer_function_desc_default()
    desc%color = c_loc(color(1, 1))
    desc%color_count = size(color, 2, c_int64_t)
    desc%extinction = c_loc(extinction(1, 1))
    desc%extinction_count = size(extinction, 2, c_int64_t)
    status = tetcast_transfer_function_create(context, desc, transfer_function)
  end function

  ! A frame whose pixels are an array of the program's, 4 × width × height: red, green, blue, alpha, from the top. It must
  ! be a `target` and stay while the frame lives.
  function tetcast_make_frame(context, pixels, frame) result(status)
    type(c_ptr), intent(in) :: context
    real(c_double), intent(inout), target :: pixels(:, :, :)
    type(c_ptr), intent(out) :: frame
    integer(c_int) :: status
    type(TetcastFrameDesc) :: desc
    integer(c_int64_t) :: component, pixel
    frame = c_null_ptr
    status = tetcast_error_argument
    if (size(pixels, 1) /= 4 .or. size(pixels) == 0) return
    component = bytes_between(c_loc(pixels(1, 1, 1)), c_loc(pixels(2, 1, 1)))
    pixel = bytes_between(c_loc(pixels(1, 1, 1)), c_loc(pixels(1, min(2, size(pixels, 2)), 1)))
    if (component /= 8 .or. (size(pixels, 2) > 1 .and. pixel /= 32)) return
    desc = tetcast_frame_desc_default()
    desc%pixels = c_loc(pixels(1, 1, 1))
    desc%width = size(pixels, 2, c_int64_t)
    desc%height = size(pixels, 3, c_int64_t)
    desc%row_stride = bytes_between(c_loc(pixels(1, 1, 1)), c_loc(pixels(1, 1, min(2, size(pixels, 3)))))
    status = tetcast_frame_create(context, desc, frame)
  end function

  ! ── views of arrays ──

  function bytes_between(first, second) result(bytes)
    type(c_ptr), intent(in) :: first, second
    integer(c_int64_t) :: bytes
    bytes = int(transfer(second, 0_c_intptr_t) - transfer(first, 0_c_intptr_t), c_int64_t)
  end function

  ! A view of `count` columns from where the first number, the one below it and the one beside it lie; the last two are the
  ! first where there is no other. Fortran's numbers of a type take `bytes` each.
  function view_of(type, bytes, count, first, below, beside) result(view)
    integer(c_int), intent(in) :: type
    integer, intent(in) :: bytes
    integer(c_int64_t), intent(in) :: count
    type(c_ptr), intent(in) :: first, below, beside
    type(TetcastArray) :: view
    integer(c_int64_t) :: step
    step = bytes_between(first, below)
    view = TetcastArray(data=first, type=type, count=count, stride=bytes_between(first, beside))
    if (step /= 0 .and. step /= bytes) view%type = tetcast_type_none
  end function

  function array_float32(values) result(view)
    real(c_float), intent(in), target :: values(:)
    type(TetcastArray) :: view
    view%type = tetcast_type_float32
    if (size(values) > 0) view = view_of(view%type, 4, size(values, 1, c_int64_t), c_loc(values(1)), c_loc(values(1)), &
      c_loc(values(min(2, size(values)))))
  end function

  function array_float64(values) result(view)
    real(c_double), intent(in), target :: values(:)
    type(TetcastArray) :: view
    view%type = tetcast_type_float64
    if (size(values) > 0) view = view_of(view%type, 8, size(values, 1, c_int64_t), c_loc(values(1)), c_loc(values(1)), &
      c_loc(values(min(2, size(values)))))
  end function

  function array_int32(values) result(view)
    integer(c_int32_t), intent(in), target :: values(:)
    type(TetcastArray) :: view
    view%type = tetcast_type_int32
    if (size(values) > 0) view = view_of(view%type, 4, size(values, 1, c_int64_t), c_loc(values(1)), c_loc(values(1)), &
      c_loc(values(min(2, size(values)))))
  end function

  function array_int64(values) result(view)
    integer(c_int64_t), intent(in), target :: values(:)
    type(TetcastArray) :: view
    view%type = tetcast_type_int64
    if (size(values) > 0) view = view_of(view%type, 8, size(values, 1, c_int64_t), c_loc(values(1)), c_loc(values(1)), &
      c_loc(values(min(2, size(values)))))
  end function

  function array_float32_columns(values) result(view)
    real(c_float), intent(in), target :: values(:, :)
    type(TetcastArray) :: view
    view%type = tetcast_type_float32
    if (size(values) > 0) view = view_of(view%type, 4, size(values, 2, c_int64_t), c_loc(values(1, 1)), &
      c_loc(values(min(2, size(values, 1)), 1)), c_loc(values(1, min(2, size(values, 2)))))
  end function

  function array_float64_columns(values) result(view)
    real(c_double), intent(in), target :: values(:, :)
    type(TetcastArray) :: view
    view%type = tetcast_type_float64
    if (size(values) > 0) view = view_of(view%type, 8, size(values, 2, c_int64_t), c_loc(values(1, 1)), &
      c_loc(values(min(2, size(values, 1)), 1)), c_loc(values(1, min(2, size(values, 2)))))
  end function

  function array_int32_columns(values) result(view)
    integer(c_int32_t), intent(in), target :: values(:, :)
    type(TetcastArray) :: view
    view%type = tetcast_type_int32
    if (size(values) > 0) view = view_of(view%type, 4, size(values, 2, c_int64_t), c_loc(values(1, 1)), &
      c_loc(values(min(2, size(values, 1)), 1)), c_loc(values(1, min(2, size(values, 2)))))
  end function

  function array_int64_columns(values) result(view)
    integer(c_int64_t), intent(in), target :: values(:, :)
    type(TetcastArray) :: view
    view%type = tetcast_type_int64
    if (size(values) > 0) view = view_of(view%type, 8, size(values, 2, c_int64_t), c_loc(values(1, 1)), &
      c_loc(values(min(2, size(values, 1)), 1)), c_loc(values(1, min(2, size(values, 2)))))
  end function

end module
