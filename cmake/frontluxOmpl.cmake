# frontlux_ompl, since OMPL 1.5 has no target, and its list of libraries goes on with what it was built with: the library
# itself comes first. Used by our build and, installed, by find_package(frontlux COMPONENTS planner).
# Of its include folders some need not exist: Debian 13 names one of a package that it does not depend on.
if(NOT TARGET frontlux_ompl)
  list(GET OMPL_LIBRARIES 0 frontlux_ompl_library)
  set(frontlux_ompl_folders "")
  foreach(folder IN LISTS OMPL_INCLUDE_DIRS)
    if(IS_DIRECTORY ${folder})
      list(APPEND frontlux_ompl_folders ${folder})
    endif()
  endforeach()
  add_library(frontlux_ompl INTERFACE IMPORTED)
  set_target_properties(frontlux_ompl PROPERTIES
    INTERFACE_INCLUDE_DIRECTORIES "${frontlux_ompl_folders}" INTERFACE_LINK_LIBRARIES "${frontlux_ompl_library}")
endif()
