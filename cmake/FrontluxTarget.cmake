# Parsing Eigen and the standard library is half of what compiling us takes: the engine's precompiled header does it
# once, for all targets. It is no part of what is installed, and every file still includes what it uses
# (tests start from support/test.hpp).
option(FRONTLUX_PRECOMPILE_HEADERS "Precompile Eigen and the standard library" ${PROJECT_IS_TOP_LEVEL})

# frontlux_target(NAME [PRECOMPILE header... | PRECOMPILED_BY target]): the language level and the warnings that every
# target of ours has. Position-independent, since a precompiled header serves only what is compiled alike.
function(frontlux_target name)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "PRECOMPILED_BY" "PRECOMPILE")
  target_compile_features(${name} PUBLIC cxx_std_20)
  # Of a shared library only what FRONTLUX_EXPORT names is visible (<frontlux/export.hpp>).
  # Without a macro of its own for that, the library is compiled with the precompiled header of another one.
  set_target_properties(${name} PROPERTIES CXX_EXTENSIONS OFF CXX_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON
    DEFINE_SYMBOL "")
  # Ours is compiled file by file even if the project around it is not.
  set_target_properties(${name} PROPERTIES UNITY_BUILD OFF)
  # The ray contract is bit for bit: a fused multiply-add rounds once where castRay rounds twice
  # (docs/ray_contract.md). x86-64 has none by default; other machines, or a user's flags, do. Fast maths of the
  # project around us is undone.
  # Nobody reads errno or the flags of floating-point exceptions here; without them more loops become vectors.
  target_compile_options(${name} PRIVATE -fPIC -fno-fast-math -ffp-contract=off -fno-math-errno
    -fno-trapping-math -Wall -Wextra -Wpedantic -Wshadow -Wconversion)
  # GCC 12 sees an overlap in an inlined `"text" + std::string` where there is none (its bug 105651), and GCC 14 a write
  # beyond a vector that has just grown.
  target_compile_options(${name} PRIVATE $<$<CXX_COMPILER_ID:GNU>:-Wno-restrict -Wno-stringop-overflow>)
  if(FRONTLUX_OPTIMISE)
    target_compile_options(${name} PRIVATE -O3)
    target_compile_definitions(${name} PRIVATE NDEBUG)
  endif()
  if(FRONTLUX_WARNINGS_AS_ERRORS)
    target_compile_options(${name} PRIVATE -Werror)
  endif()
  if(FRONTLUX_PRECOMPILE_HEADERS)
    # Without the option ccache cannot tell what a precompiled header holds.
    target_compile_options(${name} PRIVATE $<$<CXX_COMPILER_ID:GNU>:-fpch-preprocess>)
    # As TBB's target defines it for those that link it: GCC takes a precompiled header only where macros are the same.
    target_compile_definitions(${name} PRIVATE $<$<CONFIG:Debug>:TBB_USE_DEBUG>)
    if(arg_PRECOMPILE)
      target_precompile_headers(${name} PRIVATE <Eigen/Geometry> <algorithm> <array> <cmath> <cstdint> <filesystem>
        <functional> <map> <memory> <optional> <span> <stdexcept> <string> <string_view> <vector> ${arg_PRECOMPILE})
    elseif(arg_PRECOMPILED_BY)
      target_precompile_headers(${name} REUSE_FROM ${arg_PRECOMPILED_BY})
    else()
      target_precompile_headers(${name} REUSE_FROM frontlux_engine)
    endif()
  endif()
endfunction()

# frontlux_compile_together(NAME file...): as one translation unit, for files that instantiate the same templates: that
# takes longer than everything else of them. Their unnamed namespaces become one.
function(frontlux_compile_together name first)
  if(FRONTLUX_PRECOMPILE_HEADERS)
    set_target_properties(${name} PROPERTIES UNITY_BUILD ON UNITY_BUILD_MODE GROUP)
    get_filename_component(group ${first} NAME_WE)
    set_source_files_properties(${first} ${ARGN} PROPERTIES UNITY_GROUP ${group})
  endif()
endfunction()

# frontlux_shared_twin(NAME): the shared library frontlux_NAME_shared of the same objects as a static one: for the tests of
# what leaves it, and for the modules of Python, which have to share one engine (docs/architecture.md).
function(frontlux_shared_twin name)
  add_library(frontlux_${name}_shared SHARED $<TARGET_OBJECTS:frontlux_${name}>)
  get_target_property(linked frontlux_${name} LINK_LIBRARIES)
  list(TRANSFORM linked REPLACE "^frontlux::(.*)$" "frontlux_\\1_shared")
  get_target_property(folders frontlux_${name} INTERFACE_INCLUDE_DIRECTORIES)
  target_link_libraries(frontlux_${name}_shared PUBLIC ${linked})
  target_include_directories(frontlux_${name}_shared INTERFACE ${folders})
  target_compile_features(frontlux_${name}_shared INTERFACE cxx_std_20)
  set_target_properties(frontlux_${name}_shared PROPERTIES LINKER_LANGUAGE CXX)
endfunction()

# frontlux_find_libraries_from(TARGET folder): wherever they are installed together, the target in this folder of the prefix
# finds our shared libraries.
function(frontlux_find_libraries_from target folder)
  if(NOT DEFINED CMAKE_INSTALL_RPATH AND NOT IS_ABSOLUTE "${CMAKE_INSTALL_LIBDIR}")
    file(RELATIVE_PATH libraries /prefix/${folder} /prefix/${CMAKE_INSTALL_LIBDIR})
    string(REGEX REPLACE "/$" "" libraries "$ORIGIN/${libraries}")
    set_target_properties(${target} PROPERTIES INSTALL_RPATH "${libraries}")
  endif()
endfunction()

# frontlux_install(NAME EXPORT): installs the library frontlux_NAME and its public headers as frontlux::NAME.
function(frontlux_install name export)
  # Before 1.0 a new minor version may break users, so it is a new library name.
  set_target_properties(frontlux_${name} PROPERTIES EXPORT_NAME ${name}
    VERSION ${PROJECT_VERSION} SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})
  frontlux_find_libraries_from(frontlux_${name} ${CMAKE_INSTALL_LIBDIR})
  if(FRONTLUX_INSTALL)
    install(TARGETS frontlux_${name} EXPORT ${export})
    install(DIRECTORY include/frontlux DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
  endif()
  get_target_property(type frontlux_${name} TYPE)
  if(type STREQUAL STATIC_LIBRARY AND (FRONTLUX_BUILD_TESTS OR (FRONTLUX_BUILD_PYTHON AND FRONTLUX_BUILD_PLANNER)))
    frontlux_shared_twin(${name})
  endif()
endfunction()
