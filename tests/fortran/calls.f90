! SPDX-License-Identifier: Apache-2.0
! The module as a program uses it: each kind of argument once, and pictures that agree to the bit whichever way the mesh
! came in.
module heard
  use tetcast
  implicit none
  character(len=:), allocatable :: last_message
  integer :: calls_of_progress = 0
contains
  subroutine hear(user, severity, text) bind(c)
    type(c_ptr), value :: user
    integer(c_int), value :: severity
    type(c_ptr), value :: text
    integer, pointer :: messages
    call c_f_pointer(user, messages)
    messages = messages + 1
    last_message = tetcast_string(text)
    if (severity /= tetcast_severity_error) last_message = 'not an error: ' // last_message
  end subroutine

  function refuse(user, fraction) result(goes_on) bind(c)
    type(c_ptr), value :: user
    real(c_double), value :: fraction
    logical(c_bool) :: goes_on
    calls_of_progress = calls_of_progress + 1
    goes_on = c_associated(user) .or. fraction < 0
  end function
end module

program calls
  use tetcast
  use heard
  implicit none
  integer, parameter :: width = 40, height = 30
  ! An octahedron around an axis.
  real(c_double), target :: x(3, 6) = reshape( &
    [0d0, 0d0, 1d0, 0d0, 0d0, -1d0, 1d0, 0d0, 0d0, 0d0, 1d0, 0d0, -1d0, 0d0, 0d0, 0d0, -1d0, 0d0], [3, 6])
  integer(c_int32_t), target :: cells(4, 4) = reshape([1, 2, 3, 4, 1, 2, 4, 5, 1, 2, 5, 6, 1, 2, 6, 3], [4, 4])
  real(c_double), target :: u(6) = [1d0, 0d0, 0.5d0, 0.6d0, 0.7d0, 0.8d0]
  real(c_double), target :: plain(4, width, height)
  integer, target :: messages = 0
  integer :: failures = 0
  type(c_ptr) :: context, volume, field, transfer_function
  type(TetcastContextDesc) :: desc

  call expect(tetcast_string(c_null_ptr) == '', 'no string is empty')
  call expect(index(tetcast_string(tetcast_version_string()), '.') > 1, 'a version')
  call expect(tetcast_string(tetcast_status_string(tetcast_ok)) /= &
    tetcast_string(tetcast_status_string(tetcast_error_data)), 'phrases of statuses')

  desc = tetcast_context_desc_default()
  desc%threads = 2
  desc%message = c_funloc(hear)
  desc%message_user = c_loc(messages)
  call tetcast_check(tetcast_context_create(desc, context))
  call expect(tetcast_context_threads(context) == 2, 'threads')
  call make_volume(tetcast_array(x), tetcast_array(cells), volume)
  call tetcast_check(tetcast_make_field(context, tetcast_array(u), field))
  call tetcast_check(tetcast_make_transfer_function(context, &
    reshape([0d0, 0.1d0, 0.3d0, 0.9d0, 1d0, 1d0, 0.5d0, 0.1d0], [4, 2]), reshape([0d0, 0.2d0, 1d0, 3d0], [2, 2]), &
    transfer_function))
  call render(volume, field, plain)
  call expect(maxval(plain(4, :, :)) > 0.3 .and. all(plain(:, 1, 1) == 0), 'a picture')

  call meshes_of_any_array()
  call bad_meshes()
  call frames()
  call fields_and_statistics()
  call scenes()
  call cut_cells()

  call tetcast_transfer_function_destroy(transfer_function)
  call tetcast_field_destroy(field)
  call tetcast_volume_destroy(volume)
  call tetcast_context_destroy(context)
  call expect(.not. c_associated(context), 'destroyed objects are null')
  if (failures > 0) error stop 1
contains
  subroutine expect(condition, what)
    logical, intent(in) :: condition
    character(len=*), intent(in) :: what
    if (condition) return
    print '(2a)', 'not as it should be: ', what
    if (allocated(last_message)) print '(2a)', 'the last message: ', last_message
    failures = failures + 1
  end subroutine

  subroutine make_volume(vertices, tetrahedra, made)
    type(TetcastArray), intent(in) :: vertices, tetrahedra
    type(c_ptr), intent(out) :: made
    type(c_ptr) :: mesh
    call tetcast_check(tetcast_make_mesh(context, vertices, tetrahedra, mesh, tetcast_borrow))
    call tetcast_check(tetcast_volume_create(context, mesh, tetcast_volume_desc_default(), made))
    call tetcast_mesh_destroy(mesh)
  end subroutine

  function camera() result(made)
    type(TetcastCamera) :: made
    made = TetcastCamera(eye=[2d0, -5d0, 2.5d0], target=[0d0, 0d0, 0d0], up=[0d0, 0d0, 1d0], fovy=24d0)
  end function

  subroutine render(seen, with, pixels)
    type(c_ptr), intent(in) :: seen, with
    real(c_double), intent(inout), target :: pixels(:, :, :)
    type(c_ptr) :: scene, frame
    type(TetcastRenderStats) :: stats
    call tetcast_check(tetcast_scene_create(context, seen, scene))
    call tetcast_check(tetcast_scene_set_field(scene, with))
    call tetcast_check(tetcast_scene_set_transfer_function(scene, transfer_function))
    call tetcast_check(tetcast_make_frame(context, pixels, frame))
    call tetcast_check(tetcast_scene_render(scene, camera(), tetcast_render_desc_default(), frame, stats))
    call expect(stats%rays == size(pixels, 2) * size(pixels, 3) .and. stats%lost == 0, 'rays')
    call expect(tetcast_string(stats%precision) == 'double', 'precision')
    call tetcast_frame_destroy(frame)
    call tetcast_scene_destroy(scene)
  end subroutine

  subroutine same_picture(vertices, tetrahedra, what)
    type(TetcastArray), intent(in) :: vertices, tetrahedra
    character(len=*), intent(in) :: what
    real(c_double), target :: pixels(4, width, height)
    type(c_ptr) :: other
    call make_volume(vertices, tetrahedra, other)
    call render(other, field, pixels)
    call tetcast_volume_destroy(other)
    call expect(all(pixels == plain), what)
  end subroutine

  subroutine meshes_of_any_array()
    real(c_double), target :: wide(7, 12)
    real(c_float), target :: single(3, 6)
    integer(c_int64_t), target :: long(4, 4)
    integer(c_int32_t), target :: spread(8, 4), from_zero(4, 4)
    type(c_ptr) :: mesh, other
    type(TetcastMeshDesc) :: mesh_desc
    real(c_double), target :: pixels(4, width, height)
    integer(c_int64_t) :: corners(4)
    wide = -1
    wide(3:5, ::2) = x
    single = real(x, c_float)
    long = cells
    spread(::2, :) = cells
    call same_picture(tetcast_array(wide(3:5, ::2)), tetcast_array(cells), 'a section of vertices')
    call same_picture(tetcast_array(x), tetcast_array(long), 'cells of 8 bytes')
    call make_volume(tetcast_array(single), tetcast_array(cells), other)
    call render(other, field, pixels)
    call expect(maxval(abs(pixels - plain)) < 1e-6, 'vertices in single precision')
    call tetcast_volume_destroy(other)
    call expect(tetcast_make_mesh(context, tetcast_array(x), tetcast_array(spread(::2, :)), mesh) == &
      tetcast_error_argument, 'columns with gaps are refused')
    from_zero = cells - 1
    mesh_desc = tetcast_mesh_desc_default()
    mesh_desc%vertices = tetcast_array(x)
    mesh_desc%tetrahedra = tetcast_array(from_zero)
    call tetcast_check(tetcast_mesh_create(context, mesh_desc, mesh))
    call expect(tetcast_mesh_index_base(mesh) == 0, 'counted from 0')
    call expect(tetcast_mesh_tetrahedron_count(mesh) == 4, 'four cells')
    call tetcast_mesh_tetrahedron(mesh, 1_c_int64_t, corners)
    call expect(all(corners == from_zero(:, 2)), 'a tetrahedron')
    call tetcast_check(tetcast_volume_create(context, mesh, tetcast_volume_desc_default(), other))
    call render(other, field, pixels)
    call expect(all(pixels == plain), 'cells that count from 0')
    call tetcast_volume_destroy(other)
    call tetcast_mesh_destroy(mesh)
  end subroutine

  subroutine bad_meshes()
    type(c_ptr) :: mesh
    integer(c_int32_t), target :: bad(4, 4)
    integer :: before
    bad = cells
    bad(3, 2) = 0
    before = messages
    call expect(tetcast_make_mesh(context, tetcast_array(x), tetcast_array(bad), mesh) == tetcast_error_data, 'index 0')
    call expect(messages == before + 1, 'one message')
    call expect(last_message == 'tetrahedron 2 names vertex 0, but there are 6 vertices, counted from 1', 'its text')
    call expect(.not. c_associated(mesh), 'no mesh')
  end subroutine

  subroutine frames()
    real(c_double), target :: large(4, width + 5, height + 3), small(3, width, height), one(4, 1, 1)
    type(c_ptr) :: frame
    large = -7
    call render(volume, field, large(:, 4:width + 3, 2:height + 1))
    call expect(all(large(:, 4:width + 3, 2:height + 1) == plain), 'a frame within a larger one')
    call expect(count(large == -7) == 4 * ((width + 5) * (height + 3) - width * height), 'nothing beside it')
    call expect(tetcast_make_frame(context, small, frame) == tetcast_error_argument, 'pixels of three')
    call expect(tetcast_make_frame(context, large(:, ::2, :), frame) == tetcast_error_argument, 'gaps between pixels')
    call tetcast_check(tetcast_make_frame(context, one, frame))
    call expect(tetcast_frame_row_stride(frame) == 32, 'one pixel')
    call expect(tetcast_frame_type(frame) == tetcast_type_float64, 'of doubles')
    call tetcast_frame_destroy(frame)
  end subroutine

  subroutine fields_and_statistics()
    type(c_ptr) :: mesh, of_cells, pointer
    type(TetcastStatistics), pointer :: statistics
    type(TetcastArray) :: array
    type(TetcastChannelInfo), pointer :: channel => null()
    real(c_double), pointer :: values(:), volumes(:)
    real(c_float), target :: of_four(4) = [3., 1., 4., 1.5]
    real(c_double) :: range(2), medians(1)
    integer(c_int64_t) :: not_finite
    integer(c_int) :: i
    call tetcast_field_range(field, range, not_finite)
    call expect(all(range == [0d0, 1d0]) .and. not_finite == 0, 'the range of a field')
    array = tetcast_field_values(field)
    call c_f_pointer(array%data, values, [array%count])
    call expect(all(values == u), 'the values of a field')
    call tetcast_check(tetcast_make_field(context, tetcast_array(of_four), of_cells, tetcast_cell))
    call expect(tetcast_field_association(of_cells) == tetcast_cell, 'a field of cells')
    call expect(tetcast_field_value(of_cells, 3_c_int64_t) == 1.5d0, 'a value')
    call tetcast_field_destroy(of_cells)

    call tetcast_check(tetcast_make_mesh(context, tetcast_array(x), tetcast_array(cells), mesh))
    call tetcast_check(tetcast_statistics_create(context, mesh, field, tetcast_statistics_desc_default(), pointer))
    call c_f_pointer(pointer, statistics)
    call c_f_pointer(statistics%volume, volumes, [statistics%bins])
    call expect(abs(sum(volumes) - 4d0 / 3) < 1d-12, 'the volume of an octahedron')
    call tetcast_statistics_destroy(context, pointer)
    call tetcast_check(tetcast_statistics_quantiles(context, mesh, field, [0.5d0], 1_c_int, medians))
    call expect(medians(1) > 0.4 .and. medians(1) < 0.7, 'the median')
    call tetcast_mesh_destroy(mesh)

    do i = 0, 20
      pointer = tetcast_channel_info(i)
      if (.not. c_associated(pointer)) exit
      call c_f_pointer(pointer, channel)
      if (channel%channel == tetcast_channel_normal) exit
    end do
    call expect(tetcast_string(channel%name) == 'normal' .and. channel%components == 3, 'a channel')
    call expect(.not. c_associated(tetcast_channel_info(99_c_int)), 'no channel')
  end subroutine

  subroutine scenes()
    type(c_ptr) :: scene, frame, preset
    type(TetcastRenderDesc) :: render_desc
    type(TetcastRenderStats) :: stats
    type(TetcastShadingDesc) :: shading
    type(TetcastLight), target :: lights(2)
    type(TetcastCoefficientsDesc) :: coefficients
    type(c_ptr), target :: groups(3)
    real(c_double), target :: pixels(4, width, height)
    call tetcast_check(tetcast_scene_create(context, volume, scene))
    call tetcast_check(tetcast_scene_set_field(scene, field))
    call tetcast_check(tetcast_scene_create_preset(scene, 'viridis' // c_null_char, 0d0, 1d0, preset))
    call tetcast_check(tetcast_scene_set_transfer_function(scene, preset))
    call tetcast_transfer_function_destroy(preset)
    call tetcast_check(tetcast_make_frame(context, pixels, frame))

    render_desc = tetcast_render_desc_default()
    render_desc%progress%function = c_funloc(refuse)
    call tetcast_check(tetcast_context_set_threads(context, 1_c_int)) ! others might be done before the calling one reports
    call expect(tetcast_scene_render(scene, camera(), render_desc, frame, stats) == tetcast_error_cancelled, 'cancelled')
    call expect(calls_of_progress == 1, 'one call of the progress function')

    call tetcast_check(tetcast_scene_set_isosurfaces(scene, &
      [TetcastIsosurface(0.4d0, [1d0, 0d0, 0d0], 0.5d0), TetcastIsosurface(0.8d0, [0d0, 1d0, 0d0], 1d0)], 2_c_int))
    call tetcast_check(tetcast_scene_set_slices(scene, [TetcastSlice([1d0, 0d0, 0d0], 0d0, 0.5d0)], 1_c_int))
    call tetcast_check(tetcast_scene_set_boundary(scene, TetcastBoundary(opacity=0.1d0)))
    call tetcast_check(tetcast_scene_set_clip(scene, [TetcastHalfSpace([0d0, 1d0, 0d0], -0.5d0)], 1_c_int))
    shading = tetcast_shading_desc_default()
    lights(1) = TetcastLight([1d0, 0d0, 0d0], [1d0, 1d0, 1d0])
    lights(2) = TetcastLight([0d0, -1d0, 1d0], [0.5d0, 0.5d0, 0d0])
    shading%lights = c_loc(lights)
    shading%light_count = 2
    call tetcast_check(tetcast_scene_set_shading(scene, shading))
    call tetcast_check(tetcast_scene_render(scene, camera(), tetcast_render_desc_default(), frame, stats))
    call expect(maxval(abs(pixels - plain)) > 0.1, 'surfaces')
    call tetcast_scene_destroy(scene)

    ! Three groups, each of which emits what the scalar says.
    call tetcast_check(tetcast_scene_create(context, volume, scene))
    groups = field
    coefficients = tetcast_coefficients_desc_default()
    coefficients%emission = c_loc(groups)
    coefficients%emission_count = 3
    call tetcast_check(tetcast_scene_set_coefficients(scene, coefficients))
    call expect(tetcast_scene_groups(scene) == 3, 'groups')
    call tetcast_check(tetcast_scene_render(scene, camera(), tetcast_render_desc_default(), frame, stats))
    call expect(all(pixels(1, :, :) == pixels(3, :, :)) .and. maxval(pixels(1, :, :)) > 0.5, 'emission')
    call tetcast_scene_destroy(scene)
    call tetcast_frame_destroy(frame)
  end subroutine

  subroutine cut_cells()
    real(c_double), target :: corners(3, 8) = reshape( &
      [0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, 0, 0, 1, 1, 0, 1, 1, 1, 1, 0, 1, 1], [3, 8]) * 1d0
    integer(c_int32_t), target :: nodes(8, 1) = reshape([0, 1, 2, 3, 4, 5, 6, 7], [8, 1])
    integer(c_int8_t), target :: types(1) = int(tetcast_cell_hexahedron, c_int8_t)
    type(TetcastCellsDesc) :: cells_desc
    type(TetcastCutInfo) :: info
    type(TetcastArray) :: tetrahedra
    type(c_ptr) :: cut
    integer(c_int32_t), pointer :: vertices(:, :)
    integer(c_int64_t), target :: offsets(2) = [0, 8]
    cells_desc = tetcast_cells_desc_default()
    cells_desc%vertices = tetcast_array(corners)
    cells_desc%types = c_loc(types)
    cells_desc%offsets = tetcast_array(offsets)
    cells_desc%connectivity = tetcast_array(nodes(:, 1))
    call tetcast_check(tetcast_cells_cut(context, cells_desc, cut))
    call tetcast_cut_info(cut, info)
    call expect(info%cells == 1 .and. info%tetrahedra >= 5, 'a hexahedron in tetrahedra')
    tetrahedra = tetcast_cut_tetrahedra(cut)
    call c_f_pointer(tetrahedra%data, vertices, [4_c_int64_t, tetrahedra%count])
    call expect(minval(vertices) == 0 .and. maxval(vertices) == 7, 'its corners')
    call tetcast_cut_destroy(cut)
  end subroutine
end program
