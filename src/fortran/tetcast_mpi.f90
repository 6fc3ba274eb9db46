! SPDX-License-Identifier: Apache-2.0
! tetcast for MPI programs in Fortran 2008: the functions of include/tetcast/mpi.h, which says what each of them does. It is
! compiled after tetcast.f90, whose words on objects, structs and arrays hold here as well, and needs no module of MPI's: a
! communicator is an integer, MPI_COMM_WORLD of `use mpi` or MPI_COMM_WORLD%MPI_VAL of `use mpi_f08`.
!
! All ranks pass a camera, a desc and bounds, of which rank 0's hold; c_null_ptr is the frame of the others. `scenes` may
! have no elements.
module tetcast_mpi
  use, intrinsic :: iso_c_binding
  use tetcast
  implicit none

  ! What was done to make a picture.
  type, bind(c) :: TetcastMpiStats
    integer(c_int64_t) :: segments
    integer(c_int64_t) :: lost
    integer(c_int64_t) :: fragments
    real(c_double) :: overlap
    integer(c_int64_t) :: bytes
    integer(c_int64_t) :: most_bytes
    integer(c_int64_t) :: memory
    integer(c_int64_t) :: bands
    integer(c_int64_t) :: redone
    real(c_double) :: render_seconds
    real(c_double) :: wait_seconds
    real(c_double) :: exchange_seconds
    real(c_double) :: composite_seconds
    real(c_double) :: gather_seconds
    type(c_ptr) :: isa
  end type

  interface
    function tetcast_mpi_create(context, communicator, mpi) result(status) bind(c)
      import
      type(c_ptr), value :: context
      integer(c_int), value :: communicator
      type(c_ptr), intent(out) :: mpi
      integer(c_int) :: status
    end function

    function tetcast_mpi_create_world(context, mpi) result(status) bind(c)
      import
      type(c_ptr), value :: context
      type(c_ptr), intent(out) :: mpi
      integer(c_int) :: status
    end function

    subroutine tetcast_mpi_destroy(mpi) bind(c)
      import
      type(c_ptr), intent(inout) :: mpi
    end subroutine

    function tetcast_mpi_rank(mpi) result(rank) bind(c)
      import
      type(c_ptr), value :: mpi
      integer(c_int) :: rank
    end function

    function tetcast_mpi_size(mpi) result(ranks) bind(c)
      import
      type(c_ptr), value :: mpi
      integer(c_int) :: ranks
    end function

    function tetcast_mpi_set_memory(mpi, bytes) result(status) bind(c)
      import
      type(c_ptr), value :: mpi
      integer(c_int64_t), value :: bytes
      integer(c_int) :: status
    end function

    function tetcast_mpi_agree(mpi, own) result(status) bind(c)
      import
      type(c_ptr), value :: mpi
      integer(c_int), value :: own
      integer(c_int) :: status
    end function

    function tetcast_mpi_bounds(mpi, bounds) result(status) bind(c)
      import
      type(c_ptr), value :: mpi
      real(c_double), intent(inout) :: bounds(6)
      integer(c_int) :: status
    end function

    function tetcast_mpi_range(mpi, range) result(status) bind(c)
      import
      type(c_ptr), value :: mpi
      real(c_double), intent(inout) :: range(2)
      integer(c_int) :: status
    end function

    function tetcast_mpi_sum(mpi, values, parts, count, sums) result(status) bind(c)
      import
      type(c_ptr), value :: mpi
      real(c_double), intent(in) :: values(*)
      integer(c_int64_t), value :: parts, count
      real(c_double), intent(out) :: sums(*)
      integer(c_int) :: status
    end function

    ! `parts` has the statistics' pointers, `whole` becomes one.
    function tetcast_mpi_statistics(mpi, parts, count, whole) result(status) bind(c)
      import
      type(c_ptr), value :: mpi
      type(c_ptr), intent(in) :: parts(*)
      integer(c_int64_t), value :: count
      type(c_ptr), intent(out) :: whole
      integer(c_int) :: status
    end function

    function tetcast_mpi_broadcast(mpi, root, data, bytes) result(status) bind(c)
      import
      type(c_ptr), value :: mpi
      integer(c_int), value :: root
      type(c_ptr), value :: data
      integer(c_int64_t), value :: bytes
      integer(c_int) :: status
    end function

    function tetcast_mpi_send(mpi, to, data, bytes) result(status) bind(c)
      import
      type(c_ptr), value :: mpi
      integer(c_int), value :: to
      type(c_ptr), value :: data
      integer(c_int64_t), value :: bytes
      integer(c_int) :: status
    end function

    function tetcast_mpi_receive(mpi, from, data, bytes) result(status) bind(c)
      import
      type(c_ptr), value :: mpi
      integer(c_int), value :: from
      type(c_ptr), value :: data
      integer(c_int64_t), value :: bytes
      integer(c_int) :: status
    end function

    function tetcast_mpi_scale_transfer_function(mpi, scenes, count, bounds, shape, camera, opacity, &
      transfer_function) result(status) bind(c)
      import
      type(c_ptr), value :: mpi
      type(c_ptr), intent(in) :: scenes(*)
      integer(c_int64_t), value :: count
      real(c_double), intent(in) :: bounds(6)
      type(c_ptr), value :: shape
      type(TetcastCamera), intent(in) :: camera
      real(c_double), value :: opacity
      type(c_ptr), intent(out) :: transfer_function
      integer(c_int) :: status
    end function

    function tetcast_mpi_fit_transfer_function(mpi, scenes, count, bounds, shape, low, high, transfer_function) &
      result(status) bind(c)
      import
      type(c_ptr), value :: mpi
      type(c_ptr), intent(in) :: scenes(*)
      integer(c_int64_t), value :: count
      real(c_double), intent(in) :: bounds(6)
      type(c_ptr), value :: shape
      real(c_double), value :: low, high
      type(c_ptr), intent(out) :: transfer_function
      integer(c_int) :: status
    end function

    function tetcast_mpi_render(mpi, scenes, count, camera, desc, frame, stats) result(status) bind(c)
      import
      type(c_ptr), value :: mpi
      type(c_ptr), intent(in) :: scenes(*)
      integer(c_int64_t), value :: count
      type(TetcastCamera), intent(in) :: camera
      type(TetcastRenderDesc), intent(in) :: desc
      type(c_ptr), value :: frame
      type(TetcastMpiStats), intent(out) :: stats
      integer(c_int) :: status
    end function
  end interface
end module
