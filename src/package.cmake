# SPDX-License-Identifier: Apache-2.0
# What `cmake --install` adds to the libraries and headers: the CMake package and the pkg-config files. Both find their
# way from where they lie, so the installed tree may be moved.
include(CMakePackageConfigHelpers)

# A client's CMake before 3.23 does not know the headers' file set.
target_include_directories(tetcast INTERFACE $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)

set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/tetcast)
install(EXPORT tetcast-targets NAMESPACE tetcast:: DESTINATION ${package_dir})

# What the libraries are linked with is private to them: a client needs neither Embree's nor VTK's CMake package.
# The Fortran module is installed as its source, as what one compiler makes of it no other one can read.
install(FILES fortran/tetcast.f90 $<$<TARGET_EXISTS:tetcast_mpi>:${CMAKE_CURRENT_SOURCE_DIR}/fortran/tetcast_mpi.f90> DESTINATION ${CMAKE_INSTALL_DATADIR}/tetcast)
file(RELATIVE_PATH to_data ${CMAKE_INSTALL_PREFIX}/${package_dir} ${CMAKE_INSTALL_FULL_DATADIR}/tetcast)
file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/package/tetcast-config.cmake @ONLY CONTENT [[
# find_package(tetcast [COMPONENTS vtk tetgen openimageio mpi fortran]): target tetcast::tetcast, and one for each adapter that is installed.
# tetcast::fortran is the Fortran module, compiled with the project that uses it, which must have enabled Fortran; with mpi there is
# tetcast::fortran_mpi besides.
include("${CMAKE_CURRENT_LIST_DIR}/tetcast-targets.cmake")
if("fortran" IN_LIST tetcast_FIND_COMPONENTS AND CMAKE_Fortran_COMPILER AND NOT TARGET tetcast_fortran)
  add_library(tetcast_fortran STATIC EXCLUDE_FROM_ALL "${CMAKE_CURRENT_LIST_DIR}/@to_data@/tetcast.f90")
  set_target_properties(tetcast_fortran PROPERTIES POSITION_INDEPENDENT_CODE ON
    Fortran_MODULE_DIRECTORY "${CMAKE_CURRENT_BINARY_DIR}/tetcast-fortran")
  target_include_directories(tetcast_fortran PUBLIC "${CMAKE_CURRENT_BINARY_DIR}/tetcast-fortran")
  target_link_libraries(tetcast_fortran PUBLIC tetcast::tetcast)
  add_library(tetcast::fortran ALIAS tetcast_fortran)
endif()
if("mpi" IN_LIST tetcast_FIND_COMPONENTS AND TARGET tetcast::mpi AND TARGET tetcast_fortran AND NOT TARGET tetcast_fortran_mpi)
  add_library(tetcast_fortran_mpi STATIC EXCLUDE_FROM_ALL "${CMAKE_CURRENT_LIST_DIR}/@to_data@/tetcast_mpi.f90")
  set_target_properties(tetcast_fortran_mpi PROPERTIES POSITION_INDEPENDENT_CODE ON
    Fortran_MODULE_DIRECTORY "${CMAKE_CURRENT_BINARY_DIR}/tetcast-fortran")
  target_link_libraries(tetcast_fortran_mpi PUBLIC tetcast::fortran tetcast::mpi)
  add_library(tetcast::fortran_mpi ALIAS tetcast_fortran_mpi)
endif()
foreach(component IN LISTS tetcast_FIND_COMPONENTS)
  if(TARGET tetcast::${component})
    set(tetcast_${component}_FOUND TRUE)
  else()
    set(tetcast_${component}_FOUND FALSE)
    if(tetcast_FIND_REQUIRED_${component})
      set(tetcast_FOUND FALSE)
      set(tetcast_NOT_FOUND_MESSAGE "this tetcast has no component \"${component}\": it was built without it")
      if(component STREQUAL "fortran")
        set(tetcast_NOT_FOUND_MESSAGE "the component \"fortran\" needs a project that has enabled Fortran")
      endif()
    endif()
  endif()
endforeach()
]])
write_basic_package_version_file(${PROJECT_BINARY_DIR}/package/tetcast-config-version.cmake
  COMPATIBILITY SameMinorVersion) # until 1.0 a minor version may change the API
install(FILES ${PROJECT_BINARY_DIR}/package/tetcast-config.cmake ${PROJECT_BINARY_DIR}/package/tetcast-config-version.cmake
  DESTINATION ${package_dir})

# tetcast_pkgconfig(NAME DESCRIPTION REQUIRES [MODULE]): NAME.pc for library NAME, with the place of a Fortran module's source, tetcast.f90 if
# nothing else is said.
function(tetcast_pkgconfig name description requires)
  set(module tetcast.f90 ${ARGN})
  list(GET module -1 module)
  set(from ${CMAKE_INSTALL_FULL_LIBDIR}/pkgconfig)
  file(RELATIVE_PATH to_prefix ${from} ${CMAKE_INSTALL_PREFIX})
  file(RELATIVE_PATH to_include ${from} ${CMAKE_INSTALL_FULL_INCLUDEDIR})
  file(RELATIVE_PATH to_data ${from} ${CMAKE_INSTALL_FULL_DATADIR}/tetcast)
  string(REGEX REPLACE "/$" "" to_prefix "${to_prefix}")
  file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/package/${name}.pc @ONLY CONTENT [[
prefix=${pcfiledir}/@to_prefix@
libdir=${pcfiledir}/..
includedir=${pcfiledir}/@to_include@
fortran=${pcfiledir}/@to_data@/@module@

Name: @name@
Description: @description@
Version: @PROJECT_VERSION@
Requires: @requires@
Libs: -L${libdir} -l@name@
Cflags: -I${includedir}
]])
  install(FILES ${PROJECT_BINARY_DIR}/package/${name}.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
endfunction()

tetcast_pkgconfig(tetcast "${PROJECT_DESCRIPTION}" "")
set(module_mpi tetcast_mpi.f90)
foreach(adapter IN LISTS adapters)
  tetcast_pkgconfig(tetcast-${adapter} "Adapter of tetcast to ${adapter}" "tetcast = ${PROJECT_VERSION}" ${module_${adapter}})
endforeach()
