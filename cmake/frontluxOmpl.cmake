# frontlux_ompl, since OMPL 1.5 has no target, and its list of libraries goes on with what it was built with: the library
# itself comes first. Used by our build and, installed, by find_package(frontlux COMPONENTS planner).
if(NOT TARGET frontlux_ompl)
  list(GET OMPL_LIBRARIES 0 frontlux_ompl_library)
  add_library(frontlux_ompl INTERFACE IMPORTED)
  set_target_properties(frontlux_ompl PROPERTIES
    INTERFACE_INCLUDE_DIRECTORIES "${OMPL_INCLUDE_DIRS}" INTERFACE_LINK_LIBRARIES "${frontlux_ompl_library}")
endif()
