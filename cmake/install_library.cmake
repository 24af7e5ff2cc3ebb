# `cmake --install BUILD --component development` installs the library for find_package(pertev): the archives of src/
# without the laboratory, their headers, and pertev.h, which names those that are kept stable.
get_property(libraries DIRECTORY ${PROJECT_SOURCE_DIR}/src PROPERTY BUILDSYSTEM_TARGETS)
list(FILTER libraries INCLUDE REGEX "^pertev_")
list(REMOVE_ITEM libraries pertev_lab pertev_version pertev_make_lobe_tables)
if(NOT PERTEV_LAB_KERNELS)
  list(REMOVE_ITEM libraries pertev_tracer_kernels_lab)
endif()
set(development COMPONENT development EXCLUDE_FROM_ALL)
set(package ${CMAKE_INSTALL_LIBDIR}/cmake/pertev)
set(headers ${CMAKE_INSTALL_INCLUDEDIR}/pertev)
install(TARGETS ${libraries} EXPORT pertev ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR}/pertev ${development}
        INCLUDES DESTINATION ${headers})
install(EXPORT pertev FILE pertevTargets.cmake NAMESPACE pertev:: DESTINATION ${package} ${development})
install(DIRECTORY ${PROJECT_SOURCE_DIR}/src/ ${PROJECT_BINARY_DIR}/generated/ DESTINATION ${headers} ${development}
        FILES_MATCHING PATTERN "*.h" PATTERN "*.inl" PATTERN lab EXCLUDE PATTERN kernels EXCLUDE)
if(PERTEV_HAS_CUDA)
  set(PERTEV_FIND_CUDA "enable_language(CUDA)")
endif()
if(PERTEV_MPI)
  set(PERTEV_FIND_MPI "find_dependency(MPI COMPONENTS C)")
endif()
include(CMakePackageConfigHelpers)
configure_file(cmake/pertev.h.in ${PROJECT_BINARY_DIR}/install/pertev.h @ONLY)
configure_package_config_file(cmake/pertevConfig.cmake.in ${PROJECT_BINARY_DIR}/install/pertevConfig.cmake INSTALL_DESTINATION ${package})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/install/pertevConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/install/pertev.h DESTINATION ${headers} ${development})
install(FILES ${PROJECT_BINARY_DIR}/install/pertevConfig.cmake ${PROJECT_BINARY_DIR}/install/pertevConfigVersion.cmake
        DESTINATION ${package} ${development})
