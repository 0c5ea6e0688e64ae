# The reproduction on made-up runs: cmake -DREPRODUCE=bench/reproduce -DPYTHON=... -P reproduce_smoke_test.cmake

cmake_minimum_required(VERSION 3.22)

execute_process(COMMAND ${PYTHON} -B ${CMAKE_CURRENT_LIST_DIR}/reproduce_test.py ${REPRODUCE} RESULT_VARIABLE result
                OUTPUT_VARIABLE output ERROR_VARIABLE output)
if(NOT result STREQUAL 0 OR NOT output MATCHES "Ran [1-9][0-9]* tests")
  message(FATAL_ERROR "exit code ${result}:\n${output}")
endif()

# What ./dev refuses before it builds anything.
foreach(arguments "--seeds" "--seeds;0" "--quick;3" "--quick;--timed" "--methods;tuor" "--worlds")
  execute_process(COMMAND ${REPRODUCE}/../../dev reproduce ${arguments} RESULT_VARIABLE result OUTPUT_QUIET ERROR_QUIET)
  if(NOT result STREQUAL 2)
    message(FATAL_ERROR "exit code ${result} instead of 2: ./dev reproduce ${arguments}")
  endif()
endforeach()
