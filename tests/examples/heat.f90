! SPDX-License-Identifier: Apache-2.0
! A solver in Fortran that shows its field while it runs: heat spreads in the unit cube from a hot spot, by explicit steps
! of linear finite elements on tetrahedra, and every few steps a picture is written: heat0.ppm, heat1.ppm, … tetcast gets
! the solver's own arrays, with vertices counted from 1, and copies none of them.
!     gfortran $(pkg-config --variable=fortran tetcast) heat.f90 $(pkg-config --libs tetcast) -o heat
module solver
  use, intrinsic :: iso_fortran_env, only: real64, int32
  implicit none
  integer, parameter :: n = 10 ! small cubes along an edge, each of them six tetrahedra
  integer, parameter :: vertex_count = (n + 1)**3, cell_count = 6 * n**3
  real(real64), target :: x(3, vertex_count)
  integer(int32), target :: cells(4, cell_count)
  real(real64), target :: u(vertex_count)
  real(real64) :: mass(vertex_count)             ! the volume that each vertex stands for
  real(real64) :: gradient(3, 4, cell_count)     ! of the four hat functions in each cell
  real(real64), parameter :: cell_volume = 1 / (6 * real(n, real64)**3)
contains
  ! From a small cube's lowest corner to its highest along one axis after the other: six ways make six tetrahedra.
  subroutine make_mesh()
    integer, parameter :: ways(3, 6) = reshape([1, 2, 3, 1, 3, 2, 2, 1, 3, 2, 3, 1, 3, 1, 2, 3, 2, 1], [3, 6])
    integer, parameter :: step(3) = [1, n + 1, (n + 1)**2]
    integer :: i, j, k, way, leg, vertex, cell
    vertex = 0
    cell = 0
    do k = 0, n
      do j = 0, n
        do i = 0, n
          vertex = vertex + 1
          x(:, vertex) = real([i, j, k], real64) / n
          if (max(i, j, k) == n) cycle
          do way = 1, 6
            cell = cell + 1
            cells(1, cell) = vertex
            do leg = 1, 3
              cells(leg + 1, cell) = cells(leg, cell) + step(ways(leg, way))
            end do
          end do
        end do
      end do
    end do
  end subroutine

  pure function cross(a, b)
    real(real64), intent(in) :: a(3), b(3)
    real(real64) :: cross(3)
    cross = [a(2) * b(3) - a(3) * b(2), a(3) * b(1) - a(1) * b(3), a(1) * b(2) - a(2) * b(1)]
  end function

  ! The gradients of the hat functions, which add up to nothing, and each vertex' quarter of its cells.
  subroutine assemble()
    real(real64) :: edge(3, 3)
    integer :: cell, k
    mass = 0
    do cell = 1, cell_count
      do k = 1, 3
        edge(:, k) = x(:, cells(k + 1, cell)) - x(:, cells(1, cell))
      end do
      gradient(:, 2, cell) = cross(edge(:, 2), edge(:, 3))
      gradient(:, 3, cell) = cross(edge(:, 3), edge(:, 1))
      gradient(:, 4, cell) = cross(edge(:, 1), edge(:, 2))
      gradient(:, 2:4, cell) = gradient(:, 2:4, cell) / dot_product(edge(:, 1), gradient(:, 2, cell))
      gradient(:, 1, cell) = -sum(gradient(:, 2:4, cell), 2)
      mass(cells(:, cell)) = mass(cells(:, cell)) + cell_volume / 4
    end do
  end subroutine

  subroutine set_hot_spot()
    integer :: i
    do i = 1, vertex_count
      u(i) = exp(-30 * sum((x(:, i) - [0.3_real64, 0.4_real64, 0.65_real64])**2))
    end do
  end subroutine

  ! du/dt = Δu, and no heat leaves the cube.
  subroutine advance(duration)
    real(real64), intent(in) :: duration
    real(real64) :: flow(vertex_count), slope(3)
    integer :: cell
    flow = 0
    do cell = 1, cell_count
      slope = matmul(gradient(:, :, cell), u(cells(:, cell)))
      flow(cells(:, cell)) = flow(cells(:, cell)) - cell_volume * matmul(slope, gradient(:, :, cell))
    end do
    u = u + duration * flow / mass
  end subroutine
end module

program heat
  use tetcast
  use solver
  implicit none
  integer, parameter :: size_of_picture = 160, pictures = 5, steps_between = 3
  real(real64), parameter :: duration = 0.1_real64 / n**2 ! of a step; stable below 1/6 of a small cube's edge squared
  real(c_double), target :: pixels(4, size_of_picture, size_of_picture)
  integer(c_int8_t), target :: bytes(3, size_of_picture, size_of_picture)
  real(c_double), parameter :: black(4) = [0, 0, 0, 1]
  type(c_ptr) :: context, field, volume, scene, frame
  real(real64) :: heat_at_start, hottest_at_start
  integer :: picture, step

  call make_mesh()
  call assemble()
  call set_hot_spot()
  heat_at_start = dot_product(mass, u)
  hottest_at_start = maxval(u)
  call prepare()
  do picture = 0, pictures - 1
    if (picture > 0) then
      do step = 1, steps_between
        call advance(duration)
      end do
    end if
    call show(picture)
    print '(a, i0, 2(a, f9.6))', 'picture ', picture, ': heat ', dot_product(mass, u), ', hottest ', maxval(u)
  end do
  call tetcast_frame_destroy(frame)
  call tetcast_scene_destroy(scene)
  call tetcast_volume_destroy(volume)
  call tetcast_field_destroy(field)
  call tetcast_context_destroy(context)
  if (abs(dot_product(mass, u) - heat_at_start) > 1e-12_real64 * heat_at_start) error stop 'heat is not conserved'
  if (maxval(u) > 0.9_real64 * hottest_at_start .or. minval(u) < 0) error stop 'heat does not spread'
contains
  ! All that is done once. The mesh may go when there is a volume of it; field and frame refer to the program's arrays.
  subroutine prepare()
    type(TetcastContextDesc) :: desc
    type(c_ptr) :: mesh, colors
    desc = tetcast_context_desc_default()
    desc%message = c_funloc(tetcast_print_message)
    call tetcast_check(tetcast_context_create(desc, context))
    call tetcast_check(tetcast_make_mesh(context, tetcast_array(x), tetcast_array(cells), mesh, tetcast_borrow))
    call tetcast_check(tetcast_volume_create(context, mesh, tetcast_volume_desc_default(), volume))
    call tetcast_mesh_destroy(mesh)
    call tetcast_check(tetcast_make_field(context, tetcast_array(u), field, ownership=tetcast_borrow))
    call tetcast_check(tetcast_scene_create(context, volume, scene))
    call tetcast_check(tetcast_transfer_function_create_preset(context, 'inferno' // c_null_char, &
      0._c_double, 0.8_c_double, 40._c_double, colors))
    call tetcast_check(tetcast_scene_set_transfer_function(scene, colors))
    call tetcast_transfer_function_destroy(colors)
    call tetcast_check(tetcast_make_frame(context, pixels, frame))
  end subroutine

  ! What is done for each picture: the scene takes the field's values as they are now.
  subroutine show(number)
    integer, intent(in) :: number
    type(TetcastCamera) :: camera
    type(TetcastRenderStats) :: stats
    character(len=16) :: name
    camera = TetcastCamera(eye=[2.7_real64, -1.9_real64, 1.9_real64], target=[0.5_real64, 0.5_real64, 0.5_real64], &
      up=[0._real64, 0._real64, 1._real64], fovy=28._real64)
    call tetcast_check(tetcast_scene_set_field(scene, field))
    call tetcast_check(tetcast_scene_render(scene, camera, tetcast_render_desc_default(), frame, stats))
    call tetcast_check(tetcast_scene_draw_outline(scene, camera, tetcast_render_desc_default(), &
      [0.4_real64, 0.4_real64, 0.4_real64], frame))
    if (stats%lost > 0) error stop 'a ray was lost'
    write (name, '(a, i0, a)') 'heat', number, '.ppm'
    call write_ppm(trim(name))
  end subroutine

  subroutine write_ppm(name)
    character(len=*), intent(in) :: name
    integer :: unit
    character(len=32) :: head
    call tetcast_check(tetcast_frame_bytes(frame, black, 3, c_loc(bytes), 0_c_int64_t))
    open (newunit=unit, file=name, access='stream', form='unformatted', status='replace', action='write')
    write (head, '(2a, 2(i0, a))') 'P6', new_line('a'), size_of_picture, ' ', size_of_picture, new_line('a')
    write (unit) trim(head), '255', new_line('a'), bytes
    close (unit)
  end subroutine
end program
