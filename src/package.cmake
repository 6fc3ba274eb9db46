# SPDX-License-Identifier: Apache-2.0
# What `cmake --install` adds to the libraries and headers: the CMake package and the pkg-config files. Both find their
# way from where they lie, so the installed tree may be moved.
include(CMakePackageConfigHelpers)

# A client's CMake before 3.23 does not know the headers' file set.
target_include_directories(tetcast INTERFACE $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)

set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/tetcast)
install(EXPORT tetcast-targets NAMESPACE tetcast:: DESTINATION ${package_dir})

# What the libraries are linked with is private to them: a client needs neither Embree's nor VTK's CMake package.
file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/package/tetcast-config.cmake @ONLY CONTENT [[
# find_package(tetcast [COMPONENTS vtk tetgen openimageio]): target tetcast::tetcast, and one for each adapter that is installed.
include("${CMAKE_CURRENT_LIST_DIR}/tetcast-targets.cmake")
foreach(component IN LISTS tetcast_FIND_COMPONENTS)
  if(TARGET tetcast::${component})
    set(tetcast_${component}_FOUND TRUE)
  else()
    set(tetcast_${component}_FOUND FALSE)
    if(tetcast_FIND_REQUIRED_${component})
      set(tetcast_FOUND FALSE)
      set(tetcast_NOT_FOUND_MESSAGE "this tetcast has no component \"${component}\": it was built without it")
    endif()
  endif()
endforeach()
]])
write_basic_package_version_file(${PROJECT_BINARY_DIR}/package/tetcast-config-version.cmake
  COMPATIBILITY SameMinorVersion) # until 1.0 a minor version may change the API
install(FILES ${PROJECT_BINARY_DIR}/package/tetcast-config.cmake ${PROJECT_BINARY_DIR}/package/tetcast-config-version.cmake
  DESTINATION ${package_dir})

# tetcast_pkgconfig(NAME DESCRIPTION REQUIRES): NAME.pc for library NAME.
function(tetcast_pkgconfig name description requires)
  set(from ${CMAKE_INSTALL_FULL_LIBDIR}/pkgconfig)
  file(RELATIVE_PATH to_prefix ${from} ${CMAKE_INSTALL_PREFIX})
  file(RELATIVE_PATH to_include ${from} ${CMAKE_INSTALL_FULL_INCLUDEDIR})
  string(REGEX REPLACE "/$" "" to_prefix "${to_prefix}")
  file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/package/${name}.pc @ONLY CONTENT [[
prefix=${pcfiledir}/@to_prefix@
libdir=${pcfiledir}/..
includedir=${pcfiledir}/@to_include@

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
foreach(adapter IN LISTS adapters)
  tetcast_pkgconfig(tetcast-${adapter} "Adapter of tetcast to ${adapter}" "tetcast = ${PROJECT_VERSION}")
endforeach()
