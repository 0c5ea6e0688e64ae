# frontlux_target(NAME): the language level and the warnings that every target of ours has.
function(frontlux_target name)
  target_compile_features(${name} PUBLIC cxx_std_20)
  set_target_properties(${name} PROPERTIES CXX_EXTENSIONS OFF)
  # The ray contract is bit for bit: a fused multiply-add rounds once where castRay rounds twice
  # (docs/ray_contract.md). x86-64 has none by default; other machines, or a user's flags, do.
  target_compile_options(${name} PRIVATE -ffp-contract=off -Wall -Wextra -Wpedantic -Wshadow -Wconversion)
  # GCC 12 sees an overlap in an inlined `"text" + std::string` where there is none (its bug 105651).
  target_compile_options(${name} PRIVATE $<$<CXX_COMPILER_ID:GNU>:-Wno-restrict>)
  if(FRONTLUX_WARNINGS_AS_ERRORS)
    target_compile_options(${name} PRIVATE -Werror)
  endif()
endfunction()
