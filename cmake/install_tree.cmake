# `cmake --install` gives a tree that works by itself: bin/pertev (the built-in scenes are in it), our scenes, the
# documents and the licence.
include(GNUInstallDirs)

install(DIRECTORY ${PROJECT_SOURCE_DIR}/scenes/ DESTINATION ${CMAKE_INSTALL_DATADIR}/pertev/scenes)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/docs/ DESTINATION ${CMAKE_INSTALL_DOCDIR}/docs)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/bench/results/ DESTINATION ${CMAKE_INSTALL_DOCDIR}/bench/results)
install(FILES ${PROJECT_SOURCE_DIR}/README.md ${PROJECT_SOURCE_DIR}/CHANGELOG.md ${PROJECT_SOURCE_DIR}/CONTRIBUTING.md
        ${PROJECT_SOURCE_DIR}/LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR})

# The program writes its page for man and what shells complete its flags by.
install(CODE "
  set(program \"$<TARGET_FILE:pertev>\")
  set(folder \"${PROJECT_BINARY_DIR}\")
  execute_process(COMMAND \${program} --man OUTPUT_FILE \${folder}/pertev.1 COMMAND_ERROR_IS_FATAL ANY)
  execute_process(COMMAND \${program} --completion bash OUTPUT_FILE \${folder}/pertev.bash COMMAND_ERROR_IS_FATAL ANY)
  execute_process(COMMAND \${program} --completion fish OUTPUT_FILE \${folder}/pertev.fish COMMAND_ERROR_IS_FATAL ANY)
  execute_process(COMMAND \${program} --completion zsh OUTPUT_FILE \${folder}/pertev.zsh COMMAND_ERROR_IS_FATAL ANY)")
install(FILES ${PROJECT_SOURCE_DIR}/packaging/pertev-view@.service DESTINATION lib/systemd/system)
install(FILES ${PROJECT_BINARY_DIR}/pertev.1 DESTINATION ${CMAKE_INSTALL_MANDIR}/man1)
install(FILES ${PROJECT_BINARY_DIR}/pertev.bash DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions RENAME pertev)
install(FILES ${PROJECT_BINARY_DIR}/pertev.fish DESTINATION ${CMAKE_INSTALL_DATADIR}/fish/vendor_completions.d)
install(FILES ${PROJECT_BINARY_DIR}/pertev.zsh DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/vendor-completions RENAME _pertev)
