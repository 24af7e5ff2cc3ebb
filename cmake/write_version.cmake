# Run at every build (cmake -P): writes OUTPUT, a .cpp with the version and the commit, only when it would change, so that
# a new commit recompiles one file.

set(commit "")
find_program(git git)
if(git)
  execute_process(COMMAND ${git} describe --always --dirty=+ --abbrev=12 --exclude=*
    WORKING_DIRECTORY ${SOURCE_DIR} OUTPUT_VARIABLE commit OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
endif()

configure_file(${CMAKE_CURRENT_LIST_DIR}/version.cpp.in ${OUTPUT} @ONLY)
