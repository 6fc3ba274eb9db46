! SPDX-License-Identifier: Apache-2.0
! A program in Fortran whose ranks have the cells of a mesh in turn. Together they make the picture that one rank makes of
! the whole.
program ranks
  use mpi
  use tetcast
  use tetcast_mpi
  implicit none
  integer, parameter :: width = 90, height = 70
  ! An octahedron around an axis.
  real(c_double), target :: x(3, 6) = reshape( &
    [0d0, 0d0, 1d0, 0d0, 0d0, -1d0, 1d0, 0d0, 0d0, 0d0, 1d0, 0d0, -1d0, 0d0, 0d0, 0d0, -1d0, 0d0], [3, 6])
  integer(c_int32_t), target :: cells(4, 4) = reshape([1, 2, 3, 4, 1, 2, 4, 5, 1, 2, 5, 6, 1, 2, 6, 3], [4, 4])
  real(c_double), target :: u(6) = [1d0, 0d0, 0.5d0, 0.6d0, 0.7d0, 0.8d0]
  real(c_double), target :: bounds(6), together(4, width, height), alone(4, width, height)
  real(c_double) :: range(2), sums(2)
  integer(c_int32_t), allocatable, target :: own(:, :)
  integer :: i, error, level
  type(c_ptr) :: context, mpi_object, volume, scene, look, shape, frame, scenes(1)
  type(TetcastMpiStats) :: stats
  type(TetcastRenderStats) :: of_whole
  type(TetcastCamera) :: camera

  call MPI_Init_thread(MPI_THREAD_FUNNELED, level, error)
  call tetcast_check(tetcast_context_create(tetcast_context_desc_default(), context))
  call tetcast_check(tetcast_mpi_create(context, MPI_COMM_WORLD, mpi_object))
  associate (rank => tetcast_mpi_rank(mpi_object), size => tetcast_mpi_size(mpi_object))
    bounds = [1d0, -1d0, 1d0, -1d0, 1d0, -1d0] ! none
    if (rank == size - 1) bounds = [-1d0, 1d0, -1d0, 1d0, -1d0, 1d0]
    call tetcast_check(tetcast_mpi_bounds(mpi_object, bounds))
    range = [minval(u), maxval(u)]
    call tetcast_check(tetcast_mpi_range(mpi_object, range))
    call expect(all(bounds(1::2) == -1) .and. all(bounds(2::2) == 1) .and. all(range == [0, 1]), 'bounds and range')
    call tetcast_check(tetcast_mpi_sum(mpi_object, [1d0, real(rank, c_double)], 1_c_int64_t, 2_c_int64_t, sums))
    call expect(sums(1) == size .and. sums(2) == size * (size - 1) / 2, 'sums')

    own = cells(:, [(i, i = rank + 1, 4, size)])
    scenes = c_null_ptr
    if (ubound(own, 2) > 0) call make_scene(own, volume, scenes(1))
    call tetcast_check(tetcast_transfer_function_create_preset(context, 'viridis' // c_null_char, 0d0, 1d0, 1d0, shape))
    call tetcast_check(tetcast_mpi_fit_transfer_function(mpi_object, scenes, number_of(scenes), bounds, &
      shape, range(1), range(2), look))
    if (c_associated(scenes(1))) call tetcast_check(tetcast_scene_set_transfer_function(scenes(1), look))
    camera = TetcastCamera(eye=[2d0, -5d0, 2.5d0], target=[0d0, 0d0, 0d0], up=[0d0, 0d0, 1d0], fovy=24d0)
    frame = c_null_ptr
    if (rank == 0) call tetcast_check(tetcast_make_frame(context, together, frame))
    call tetcast_check(tetcast_mpi_render(mpi_object, scenes, number_of(scenes), camera, &
      tetcast_render_desc_default(), frame, stats))
    call expect(stats%lost == 0 .and. stats%fragments > 0 .and. stats%bands == 1 .and. stats%redone == 0, 'bands')
    call expect(stats%overlap < 1d-14, 'overlap')
    call expect(tetcast_string(stats%isa) /= '', 'instruction set')
    call tetcast_frame_destroy(frame)
    if (c_associated(scenes(1))) then
      call tetcast_scene_destroy(scenes(1))
      call tetcast_volume_destroy(volume)
    end if
    if (rank == 0) then
      call make_scene(cells, volume, scene)
      call tetcast_check(tetcast_scene_set_transfer_function(scene, look))
      call tetcast_check(tetcast_make_frame(context, alone, frame))
      call tetcast_check(tetcast_scene_render(scene, camera, tetcast_render_desc_default(), frame, of_whole))
      call expect(maxval(abs(together - alone)) <= 5d-15 .and. maxval(alone) > 0.1d0, 'the picture')
      call expect(of_whole%segments == stats%segments, 'segments')
      call tetcast_frame_destroy(frame)
      call tetcast_scene_destroy(scene)
      call tetcast_volume_destroy(volume)
    end if
  end associate
  call tetcast_transfer_function_destroy(look)
  call tetcast_transfer_function_destroy(shape)
  call tetcast_mpi_destroy(mpi_object)
  call tetcast_context_destroy(context)
  call MPI_Finalize(error)
contains
  subroutine make_scene(tetrahedra, made, seen)
    integer(c_int32_t), intent(in), target, contiguous :: tetrahedra(:, :)
    type(c_ptr), intent(out) :: made, seen
    type(c_ptr) :: mesh, field
    type(TetcastVolumeDesc) :: desc
    desc = tetcast_volume_desc_default()
    desc%bounds = c_loc(bounds)
    call tetcast_check(tetcast_make_mesh(context, tetcast_array(x), tetcast_array(tetrahedra), mesh))
    call tetcast_check(tetcast_volume_create(context, mesh, desc, made))
    call tetcast_mesh_destroy(mesh)
    call tetcast_check(tetcast_make_field(context, tetcast_array(u), field))
    call tetcast_check(tetcast_scene_create(context, made, seen))
    call tetcast_check(tetcast_scene_set_field(seen, field))
    call tetcast_field_destroy(field)
  end subroutine

  function number_of(some) result(number)
    type(c_ptr), intent(in) :: some(:)
    integer(c_int64_t) :: number
    number = merge(1, 0, c_associated(some(1)))
  end function

  subroutine expect(good, what)
    logical, intent(in) :: good
    character(len=*), intent(in) :: what
    integer :: failed
    if (good) return
    write (*, '(2a)') 'not as it must be: ', what
    call MPI_Abort(MPI_COMM_WORLD, 1, failed)
  end subroutine
end program
