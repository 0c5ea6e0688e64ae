# For scripts that run programs in a new, empty `folder`, named after the script.
get_filename_component(script ${CMAKE_SCRIPT_MODE_FILE} NAME_WE)
set(folder ${CMAKE_CURRENT_BINARY_DIR}/${script})
file(REMOVE_RECURSE ${folder})
file(MAKE_DIRECTORY ${folder})

# run(CODE COMMAND...): runs a command, which has to exit with this code; what it prints is in `output` and `error`.
function(run code)
  execute_process(COMMAND ${ARGN} WORKING_DIRECTORY ${folder} RESULT_VARIABLE result OUTPUT_VARIABLE output
                  ERROR_VARIABLE error)
  if(NOT result STREQUAL code)
    message(FATAL_ERROR "exit code ${result} instead of ${code}: ${ARGN}\n${output}\n${error}")
  endif()
  set(output "${output}" PARENT_SCOPE)
  set(error "${error}" PARENT_SCOPE)
endfunction()
