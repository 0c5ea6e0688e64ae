# Compiles a program as a Makefile would, with what pkg-config says of the libraries installed in FOLDER, and runs it.
file(GLOB_RECURSE file ${FOLDER}/frontlux-planner.pc)
get_filename_component(where "${file}" DIRECTORY)
set(ENV{PKG_CONFIG_PATH} "${where}:$ENV{PKG_CONFIG_PATH}")
execute_process(COMMAND ${PKG_CONFIG} --cflags --libs "frontlux-planner >= 0.1"
  OUTPUT_VARIABLE said OUTPUT_STRIP_TRAILING_WHITESPACE COMMAND_ERROR_IS_FATAL ANY)
separate_arguments(said UNIX_COMMAND "${said}")
separate_arguments(flags UNIX_COMMAND "${FLAGS}")
set(program ${FOLDER}/pkg_config_consumer)
execute_process(COMMAND ${COMPILER} -std=c++20 ${flags} ${SOURCE} -o ${program} ${said} -Wl,-rpath,${where}/..
  COMMAND_ECHO STDOUT COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND ${program} ${ROOM} COMMAND_ERROR_IS_FATAL ANY)
