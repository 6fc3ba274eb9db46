! SPDX-License-Identifier: Apache-2.0
! Rays as numbers and parts of a mesh, from Fortran: an octahedron, in which lengths and integrals have closed forms, against these,
! and a picture of it against its rays and its parts.
module traced
  use tetcast
  implicit none
  ! What a trace is made into.
  type Sums
    integer(c_int64_t) :: calls = 0, rays = 0, crossings = 0
    logical :: in_order = .true.
    real(c_double), allocatable :: length(:), integral(:) ! of each ray
    integer, allocatable :: cells(:) ! that it crosses, a bit each
  end type
  real(c_double), target :: u(6) = [1d0, 0.2d0, 0.5d0, 0.6d0, 0.7d0, 0.8d0]
contains
  function add(user, trace) result(goes_on) bind(c)
    type(c_ptr), value :: user
    type(TetcastTrace), intent(in) :: trace
    logical(c_bool) :: goes_on
    type(Sums), pointer :: of
    type(TetcastCrossing), pointer :: crossing(:)
    integer(c_int64_t), pointer :: offset(:)
    integer(c_int64_t) :: ray, i
    call c_f_pointer(user, of)
    call c_f_pointer(trace%offsets, offset, [trace%count + 1])
    call c_f_pointer(trace%crossings, crossing, [offset(trace%count + 1)])
    of%in_order = of%in_order .and. trace%first == of%rays
    of%calls = of%calls + 1
    of%rays = of%rays + trace%count
    of%crossings = of%crossings + size(crossing)
    do ray = 1, trace%count
      do i = offset(ray) + 1, offset(ray + 1)
        associate (c => crossing(i), at => trace%first + ray)
          of%length(at) = of%length(at) + c%length
          of%cells(at) = ibset(of%cells(at), c%cell)
          ! Vertices are counted from 0 here.
          of%integral(at) = of%integral(at) + c%length * sum((c%weight(:, 1) + c%weight(:, 2)) / 2 * u(c%vertex + 1))
          if (i > offset(ray) + 1) of%in_order = of%in_order .and. c%begin >= crossing(i - 1)%end
        end associate
      end do
    end do
    goes_on = .true._c_bool
  end function

  function end_at_once(user, trace) result(goes_on) bind(c)
    type(c_ptr), value :: user
    type(TetcastTrace), intent(in) :: trace
    logical(c_bool) :: goes_on
    goes_on = c_associated(user) .or. trace%count < 1
  end function
end module

program rays
  use tetcast
  use traced
  implicit none
  integer, parameter :: width = 40, height = 30, side = 24, count = side**2
  real(c_double), parameter :: color(3) = [0.9d0, 0.6d0, 0.3d0], extinction = 2
  ! An octahedron around an axis, |x| + |y| + |z| <= 1, its coordinates together and apart.
  real(c_double), target :: x(3, 6) = reshape( &
    [0d0, 0d0, 1d0, 0d0, 0d0, -1d0, 1d0, 0d0, 0d0, 0d0, 1d0, 0d0, -1d0, 0d0, 0d0, 0d0, -1d0, 0d0], [3, 6])
  real(c_double), target :: apart(6, 3), bounds(6) = [-1d0, 1d0, -1d0, 1d0, -1d0, 1d0]
  integer(c_int32_t), target :: cells(4, 4) = reshape([1, 2, 3, 4, 1, 2, 4, 5, 1, 2, 5, 6, 1, 2, 6, 3], [4, 4])
  integer(c_int8_t), target :: ghosts(4)
  real(c_double), target :: picture(4, width, height)
  ! Rays downwards through the octahedron, and beside it.
  real(c_double), target :: origins(3, count), directions(3, count), along(count), integral(count)
  integer :: failures = 0
  type(c_ptr) :: context, field, transfer_function, mesh, volume, scene

  apart = transpose(x)
  call tetcast_check(tetcast_context_create(tetcast_context_desc_default(), context))
  call tetcast_check(tetcast_make_field(context, tetcast_array(u), field))
  ! One colour, and an extinction that is the field times a number.
  call tetcast_check(tetcast_make_transfer_function(context, reshape([0d0, color, 1d0, color], [4, 2]), &
    reshape([0d0, 0d0, 1d0, extinction], [2, 2]), transfer_function))
  call tetcast_check(tetcast_make_mesh(context, tetcast_array(x), tetcast_array(cells), mesh))
  call make_scene(mesh, volume, scene)

  call aim()
  call cast_against_closed_forms()
  call trace_against_closed_forms()
  call cast_against_a_frame()
  call meshes_apart()
  call parts_against_the_whole()

  call tetcast_scene_destroy(scene)
  call tetcast_volume_destroy(volume)
  call tetcast_transfer_function_destroy(transfer_function)
  call tetcast_field_destroy(field)
  call tetcast_context_destroy(context)
  if (failures > 0) error stop 1
contains
  subroutine expect(condition, what)
    logical, intent(in) :: condition
    character(len=*), intent(in) :: what
    if (condition) return
    print '(2a)', 'not as it should be: ', what
    failures = failures + 1
  end subroutine

  subroutine make_scene(of, made_volume, made)
    type(c_ptr), intent(inout) :: of
    type(c_ptr), intent(out) :: made_volume, made
    type(TetcastVolumeDesc) :: desc
    desc = tetcast_volume_desc_default()
    desc%bounds = c_loc(bounds)
    call tetcast_check(tetcast_volume_create(context, of, desc, made_volume))
    call tetcast_mesh_destroy(of)
    call tetcast_check(tetcast_scene_create(context, made_volume, made))
    call tetcast_check(tetcast_scene_set_field(made, field))
    call tetcast_check(tetcast_scene_set_transfer_function(made, transfer_function))
  end subroutine

  ! What the field is where: linear in each of the four cells, along the axis and towards two vertices on the equator.
  function value_at(p) result(value)
    real(c_double), intent(in) :: p(3)
    real(c_double) :: value, middle
    middle = (u(1) + u(2)) / 2
    value = middle + p(3) * (u(1) - u(2)) / 2 + abs(p(1)) * (u(merge(3, 5, p(1) > 0)) - middle) + &
      abs(p(2)) * (u(merge(4, 6, p(2) > 0)) - middle)
  end function

  ! Lengths and integrals of rays along the axis: a ray is in one cell, where the mean is the value in its middle.
  subroutine aim()
    integer :: i
    do i = 1, count
      origins(:, i) = [2.2d0 * (mod(i - 1, side) + 0.5d0) / side - 1.1d0, 2.2d0 * ((i - 1) / side + 0.5d0) / side - 1.1d0, 3d0]
      directions(:, i) = [0d0, 0d0, -2d0]
      along(i) = max(0d0, 2 * (1 - abs(origins(1, i)) - abs(origins(2, i))))
      integral(i) = along(i) * value_at([origins(1:2, i), 0d0])
    end do
  end subroutine

  function all_rays() result(made)
    type(TetcastRays) :: made
    made = tetcast_rays_default()
    made%origins = tetcast_array(origins)
    made%directions = tetcast_array(directions)
  end function

  subroutine cast_against_closed_forms()
    real(c_double), target :: rgba(4, count), depth(count), length(count), error(count), ends(count)
    type(TetcastRays) :: given
    type(TetcastRenderStats) :: stats
    integer :: k
    given = all_rays()
    call tetcast_check(tetcast_scene_cast(scene, given, tetcast_cast_desc_default(), TetcastCastResult(color=c_loc(rgba), &
      optical_depth=c_loc(depth), length=c_loc(length), error=c_loc(error)), stats))
    call expect(stats%rays == count .and. stats%lost == 0, 'rays')
    call expect(maxval(abs(length - along)) < 1d-14, 'lengths')
    call expect(maxval(abs(depth - extinction * integral)) < 1d-14, 'optical depths')
    call expect(maxval(abs(rgba(4, :) - (1 - exp(-extinction * integral)))) < 1d-14, 'alpha')
    do k = 1, 3
      call expect(maxval(abs(rgba(k, :) - color(k) * rgba(4, :))) < 1d-14, 'colours')
    end do
    call expect(all(error < 1d-11) .and. count_above(error) == count_above(along), 'bounds of errors')
    ! Up to the equator, which is 1.5 of the directions' lengths away.
    ends = 1.5d0
    given%ends = tetcast_array(ends)
    call tetcast_check(tetcast_scene_cast(scene, given, tetcast_cast_desc_default(), &
      TetcastCastResult(length=c_loc(length)), stats))
    call expect(maxval(abs(length - along / 2)) < 1d-14, 'lengths of halves')
    ends(7) = -1
    call expect(tetcast_scene_cast(scene, given, tetcast_cast_desc_default(), TetcastCastResult(length=c_loc(length)), &
      stats) == tetcast_error_argument, 'a ray that ends before it begins')
  end subroutine

  function count_above(values) result(n)
    real(c_double), intent(in) :: values(:)
    integer :: n, i
    n = 0
    do i = 1, size(values)
      if (values(i) > 0) n = n + 1
    end do
  end function

  subroutine trace_against_closed_forms()
    type(Sums), target :: found
    integer :: i, cell
    logical :: right
    allocate (found%length(count), found%integral(count), found%cells(count))
    found%length = 0
    found%integral = 0
    found%cells = 0
    call tetcast_check(tetcast_volume_trace(volume, all_rays(), tetcast_trace_desc_default(), c_funloc(add), c_loc(found)))
    call expect(found%calls > 0 .and. found%rays == count .and. found%in_order, 'rays in their order')
    call expect(maxval(abs(found%length - along)) < 1d-14, 'lengths of crossings')
    call expect(maxval(abs(found%integral - integral)) < 1d-14, 'weights')
    call expect(found%crossings == count_above(along), 'a crossing a ray')
    right = .true.
    do i = 1, count ! the four cells, from 0: around the axis
      cell = merge(merge(0, 3, origins(2, i) > 0), merge(1, 2, origins(2, i) > 0), origins(1, i) > 0)
      right = right .and. found%cells(i) == merge(ibset(0, cell), 0, along(i) > 0)
    end do
    call expect(right, 'cells')
    call expect(tetcast_volume_trace(volume, all_rays(), tetcast_trace_desc_default(), c_funloc(end_at_once), c_null_ptr) &
      == tetcast_error_cancelled, 'an ended trace')
  end subroutine

  function camera() result(made)
    type(TetcastCamera) :: made
    made = TetcastCamera(eye=[2d0, -5d0, 2.5d0], target=[0d0, 0d0, 0d0], up=[0d0, 0d0, 1d0], fovy=24d0)
  end function

  function cross(a, b) result(c)
    real(c_double), intent(in) :: a(3), b(3)
    real(c_double) :: c(3)
    c = [a(2) * b(3) - a(3) * b(2), a(3) * b(1) - a(1) * b(3), a(1) * b(2) - a(2) * b(1)]
  end function

  ! Renders the picture, and casts its rays.
  subroutine cast_against_a_frame()
    real(c_double), target :: from(3, width * height), to(3, width * height), rgba(4, width, height)
    real(c_double) :: forward(3), right(3), up(3), half
    type(TetcastCamera) :: seen
    type(TetcastRays) :: given
    type(TetcastRenderStats) :: stats
    type(c_ptr) :: frame
    integer :: row, column
    seen = camera()
    forward = (seen%target - seen%eye) / norm2(seen%target - seen%eye)
    right = cross(forward, seen%up) / norm2(cross(forward, seen%up))
    up = cross(right, forward)
    half = tan(seen%fovy / 2 * acos(-1d0) / 180)
    do row = 1, height
      do column = 1, width
        associate (at => (row - 1) * width + column)
          from(:, at) = seen%eye
          to(:, at) = forward + half * ((2 * column - 1 - width) * right + (height + 1 - 2 * row) * up) / height
        end associate
      end do
    end do
    call tetcast_check(tetcast_make_frame(context, picture, frame))
    call tetcast_check(tetcast_scene_render(scene, seen, tetcast_render_desc_default(), frame, stats))
    call tetcast_frame_destroy(frame)
    given = tetcast_rays_default()
    given%origins = tetcast_array(from)
    given%directions = tetcast_array(to)
    call tetcast_check(tetcast_scene_cast(scene, given, tetcast_cast_desc_default(), TetcastCastResult(color=c_loc(rgba)), &
      stats))
    call expect(maxval(abs(rgba - picture)) < 1d-14 .and. maxval(picture) > 0.5, 'a frame and its rays')
  end subroutine

  function hidden_cells() result(hidden)
    logical :: hidden(4)
    integer(c_int64_t) :: i
    do i = 1, 4
      hidden(i) = tetcast_mesh_hides(mesh, i - 1) /= 0
    end do
  end function

  subroutine meshes_apart()
    type(TetcastArray) :: coordinates(3), none
    real(c_double) :: position(3), found(6)
    integer(c_int8_t), target :: loose(8)
    coordinates = [tetcast_array(apart(:, 1)), tetcast_array(apart(:, 2)), tetcast_array(x(3, :))]
    ghosts = [0_c_int8_t, 2_c_int8_t, 1_c_int8_t, 3_c_int8_t]
    call tetcast_check(tetcast_make_mesh(context, coordinates, tetcast_array(cells), mesh, tetcast_borrow, ghosts))
    none = tetcast_mesh_vertices(mesh)
    call expect(.not. c_associated(none%data), 'coordinates apart')
    call expect(tetcast_mesh_vertex_count(mesh) == 6, 'their number')
    call tetcast_mesh_vertex(mesh, 3_c_int64_t, position)
    call expect(all(position == x(:, 4)), 'a vertex')
    call tetcast_mesh_bounds(mesh, found)
    call expect(all(found == [0, 1, 0, 1, -1, 1]), 'bounds of what is not hidden')
    call expect(all(hidden_cells() .eqv. [.false., .true., .true., .true.]), 'hidden cells')
    ! Borrowed arrays are those of the program.
    apart(4, 1) = 8
    ghosts(3) = 0
    call tetcast_mesh_vertex(mesh, 3_c_int64_t, position)
    call expect(position(1) == 8, 'coordinates are not copied')
    call expect(all(hidden_cells() .eqv. [.false., .true., .false., .true.]), 'nor are marks')
    apart(4, 1) = x(1, 4)
    call tetcast_mesh_destroy(mesh)

    call tetcast_check(tetcast_make_mesh(context, tetcast_array(x), tetcast_array(cells), mesh, hidden=ghosts, &
      hidden_bits=1_c_int8_t))
    ghosts = 0
    call expect(all(hidden_cells() .eqv. [.false., .false., .false., .true.]), 'bits that hide')
    call tetcast_mesh_destroy(mesh)
    loose = 0
    call expect(tetcast_make_mesh(context, tetcast_array(x), tetcast_array(cells), mesh, hidden=loose(::2)) == &
      tetcast_error_argument .and. .not. c_associated(mesh), 'marks with gaps')
    call expect(tetcast_make_mesh(context, tetcast_array(x), tetcast_array(cells), mesh, hidden=loose(:3)) == &
      tetcast_error_argument, 'too few marks')
  end subroutine

  ! Two parts of two cells that lie opposite each other, each of which hides the other's.
  subroutine parts_against_the_whole()
    type(c_ptr) :: fragments(2), part_volume, part, frame
    type(TetcastFragmentList) :: lists(2)
    type(TetcastFragment), pointer :: fragment(:)
    type(TetcastRenderStats) :: stats
    real(c_double), target :: together(4, width, height)
    real(c_double) :: overlap
    integer :: i, of_part(2)
    do i = 1, 2
      ghosts = 1
      ghosts(i::2) = 0
      call tetcast_check(tetcast_make_mesh(context, tetcast_array(x), tetcast_array(cells), mesh, tetcast_borrow, ghosts))
      call make_scene(mesh, part_volume, part)
      call tetcast_check(tetcast_fragments_create(context, fragments(i)))
      call tetcast_check(tetcast_scene_render_fragments(part, camera(), tetcast_render_desc_default(), &
        int(width, c_int64_t), int(height, c_int64_t), fragments(i), stats))
      call tetcast_scene_destroy(part)
      call tetcast_volume_destroy(part_volume)
      call expect(stats%rays == width * height .and. stats%lost == 0, 'rays of a part')
      lists(i) = tetcast_fragments_list(fragments(i))
      call c_f_pointer(lists(i)%data, fragment, [lists(i)%count])
      of_part(i) = size(fragment)
      call expect(all(fragment%pixel >= 0 .and. fragment%pixel < width * height), 'pixels from 0')
      call expect(all(fragment%end > fragment%begin .and. fragment%optical_depth > 0), 'fragments')
      call expect(maxval(abs(fragment%color(2) - color(2) * (1 - exp(-fragment%optical_depth)))) < 1d-14, 'their colours')
    end do
    call expect(minval(of_part) > 100, 'fragments of both parts')
    call tetcast_check(tetcast_make_frame(context, together, frame))
    call tetcast_check(tetcast_fragments_composite(context, lists, 2_c_int64_t, frame, overlap))
    call expect(maxval(abs(together - picture)) < 5d-15, 'both parts are the whole')
    call expect(overlap < 1d-14, 'overlap')
    call tetcast_check(tetcast_fragments_composite(context, [lists(1), lists(1)], 2_c_int64_t, frame, overlap))
    call expect(overlap > 0.1, 'the overlap of a part with itself')
    call tetcast_frame_destroy(frame)
    do i = 1, 2
      call tetcast_fragments_destroy(fragments(i))
    end do
  end subroutine
end program
