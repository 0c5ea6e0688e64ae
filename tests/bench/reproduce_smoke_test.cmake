# What ./dev reproduce refuses before it builds anything: cmake -DDEV=dev -P reproduce_smoke_test.cmake

cmake_minimum_required(VERSION 3.22)

foreach(arguments "--seeds" "--seeds;0" "--quick;3" "--quick;--timed" "--methods;tuor" "--worlds")
  execute_process(COMMAND ${DEV} reproduce ${arguments} RESULT_VARIABLE result OUTPUT_QUIET ERROR_QUIET)
  if(NOT result STREQUAL 2)
    message(FATAL_ERROR "exit code ${result} instead of 2: ./dev reproduce ${arguments}")
  endif()
endforeach()
