# Installs frontlux.pc and frontlux-planner.pc, for builds without CMake. A shared library brings along what it links;
# whoever links the static one links that too. The files find their prefix from where they lie.
set(frontlux_pc_dir ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
file(RELATIVE_PATH frontlux_pc_prefix /prefix/${frontlux_pc_dir} /prefix)
string(REGEX REPLACE "/$" "" frontlux_pc_prefix "${frontlux_pc_prefix}")
if(frontlux_static)
  set(frontlux_pc_requires ", tbb")
  set(frontlux_pc_libs " -lembree${embree_VERSION_MAJOR}")
  set(frontlux_pc_planner_requires ", ipopt >= 3.11, zlib")
  set(frontlux_pc_planner_libs " -lompl")  # Debian's ompl.pc names folders that do not exist
endif()
set(frontlux_pc_files frontlux.pc)
if(FRONTLUX_BUILD_PLANNER)
  list(APPEND frontlux_pc_files frontlux-planner.pc)
endif()
foreach(file IN LISTS frontlux_pc_files)
  configure_file(${PROJECT_SOURCE_DIR}/cmake/${file}.in ${PROJECT_BINARY_DIR}/${file} @ONLY)
  install(FILES ${PROJECT_BINARY_DIR}/${file} DESTINATION ${frontlux_pc_dir})
endforeach()
