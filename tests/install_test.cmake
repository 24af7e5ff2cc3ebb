# Run by CTest (cmake -P): installs BUILD into a folder of its own, runs the program from there and looks for the rest.
set(prefix ${BUILD}/install_test)
file(REMOVE_RECURSE ${prefix})
execute_process(COMMAND ${CMAKE_COMMAND} --install ${BUILD} --prefix ${prefix} OUTPUT_QUIET COMMAND_ERROR_IS_FATAL ANY)
foreach(file share/pertev/scenes/cornell-box/cornell-box.gltf share/doc/pertev/LICENSE share/doc/pertev/README.md
             share/doc/pertev/docs/conventions.md share/doc/pertev/docs/notices.md share/doc/pertev/bench/results/jobs_h200.json share/man/man1/pertev.1 share/bash-completion/completions/pertev share/zsh/vendor-completions/_pertev)
  if(NOT EXISTS ${prefix}/${file})
    message(FATAL_ERROR "the installed tree lacks ${file}")
  endif()
endforeach()
execute_process(COMMAND ${prefix}/bin/pertev render cornell-box --size 16x16 --spp 1 -q -o ${prefix}/picture.png
                WORKING_DIRECTORY ${prefix} COMMAND_ERROR_IS_FATAL ANY)
if(NOT EXISTS ${prefix}/picture.png)
  message(FATAL_ERROR "the installed program wrote no picture")
endif()
# A debug build keeps its symbols. The program that was built has some, else this would test nothing.
if(NOT CONFIG MATCHES "^(Debug|RelWithDebInfo)$")
  execute_process(COMMAND ${NM} ${BUILD}/bin/pertev OUTPUT_VARIABLE built ERROR_QUIET COMMAND_ERROR_IS_FATAL ANY)
  execute_process(COMMAND ${NM} ${prefix}/bin/pertev OUTPUT_VARIABLE installed ERROR_QUIET)
  if(built STREQUAL "" OR NOT installed STREQUAL "")
    message(FATAL_ERROR "the installed program is not stripped")
  endif()
endif()
file(REMOVE_RECURSE ${prefix})
