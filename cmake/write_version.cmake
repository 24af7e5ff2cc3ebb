# Run at every build (cmake -P): writes OUTPUT, a .cpp with the version and the commit, only when it would change, so that
# a new commit recompiles one file. An exported tree has no commit, even where a folder above it is under git.

find_program(git git)
if(git)
  cmake_path(GET SOURCE_DIR PARENT_PATH above)
  execute_process(COMMAND ${CMAKE_COMMAND} -E env GIT_CEILING_DIRECTORIES=${above}
    ${git} describe --always --dirty=+ --abbrev=12 --exclude=*
    WORKING_DIRECTORY ${SOURCE_DIR} OUTPUT_VARIABLE commit OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
endif()
if(NOT commit)
  set(commit unknown)
endif()

configure_file(${CMAKE_CURRENT_LIST_DIR}/version.cpp.in ${OUTPUT} @ONLY)
