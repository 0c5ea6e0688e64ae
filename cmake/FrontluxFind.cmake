# frontlux_find(PACKAGE [version] [NO_MODULE] DEBIAN name [OPTION option]): find_package, which says what to install
# and which option leaves out what needs it. A macro, so that the package's variables are the caller's.
macro(frontlux_find package)
  cmake_parse_arguments(frontlux_find "" "DEBIAN;OPTION" "" ${ARGN})
  find_package(${package} ${frontlux_find_UNPARSED_ARGUMENTS} QUIET)
  if(NOT ${package}_FOUND)
    frontlux_fail_to_find("${package};${frontlux_find_UNPARSED_ARGUMENTS}" "${${package}_CONSIDERED_VERSIONS}"
      "${frontlux_find_DEBIAN}" "${frontlux_find_OPTION}")
  endif()
endmacro()

# frontlux_find_module(PREFIX module... DEBIAN name [OPTION option]): the same with pkg-config's modules, as the target
# PkgConfig::PREFIX.
macro(frontlux_find_module prefix)
  cmake_parse_arguments(frontlux_find "" "DEBIAN;OPTION" "" ${ARGN})
  find_package(PkgConfig QUIET)
  if(PkgConfig_FOUND)
    pkg_check_modules(${prefix} QUIET IMPORTED_TARGET ${frontlux_find_UNPARSED_ARGUMENTS})
  endif()
  if(NOT ${prefix}_FOUND)
    frontlux_fail_to_find("${frontlux_find_UNPARSED_ARGUMENTS}" "" "pkg-config ${frontlux_find_DEBIAN}"
      "${frontlux_find_OPTION}")
  endif()
endmacro()

function(frontlux_fail_to_find wanted others debian option)
  list(REMOVE_ITEM wanted NO_MODULE)
  list(JOIN wanted " " wanted)
  set(message "frontlux needs ${wanted}, which was not found")
  if(others)
    list(JOIN others ", " others)
    string(APPEND message " (but ${others})")
  endif()
  string(APPEND message ". Install it (Debian, Ubuntu: apt-get install ${debian}), or say where it is with CMAKE_PREFIX_PATH")
  if(option)
    string(APPEND message ", or leave out what needs it with -D${option}=OFF")
  endif()
  message(FATAL_ERROR "${message}.")
endfunction()

# Eigen from 3.3 on. Its own version file takes a request for 3.3 as one for 3, and calls 5 incompatible.
macro(frontlux_find_eigen)
  frontlux_find(Eigen3 NO_MODULE DEBIAN libeigen3-dev)
  if(Eigen3_VERSION VERSION_LESS 3.3)
    message(FATAL_ERROR "frontlux needs Eigen 3.3 or later, but ${Eigen3_DIR} has ${Eigen3_VERSION}.")
  endif()
endmacro()

# Embree 4 or, where there is none, 3.13: `embree_VERSION_MAJOR` tells which, and our sources know both.
macro(frontlux_find_embree)
  set(frontlux_given_embree "${embree_DIR}")  # which is forgotten if it has another version than is asked for
  find_package(embree 4 QUIET)
  if(NOT embree_FOUND)
    if(frontlux_given_embree)
      set(embree_DIR "${frontlux_given_embree}" CACHE PATH "Folder of embree's CMake files" FORCE)
    endif()
    frontlux_find(embree 3.13 DEBIAN libembree-dev)
  endif()
endmacro()
