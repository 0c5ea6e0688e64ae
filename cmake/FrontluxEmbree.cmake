# Embree 4 or, where there is none, 3.13: `embree_VERSION_MAJOR` tells which, and our sources know both.
find_package(embree 4 QUIET)
if(NOT embree_FOUND)
  find_package(embree 3.13 REQUIRED)
endif()
