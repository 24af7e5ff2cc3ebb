# Sources that the build writes: the version (looked at in every build) and the built-in scenes.

set(PERTEV_GENERATED_DIR ${PROJECT_BINARY_DIR}/generated)
set(PERTEV_BUILTIN_SCENES ${PROJECT_SOURCE_DIR}/scenes/cornell-box/cornell-box.gltf
    ${PROJECT_SOURCE_DIR}/scenes/many-lights/many-lights.gltf)
foreach(name blind caustic cove door uplight)
  list(APPEND PERTEV_BUILTIN_SCENES ${PROJECT_SOURCE_DIR}/scenes/transport/${name}.obj)
  list(APPEND PERTEV_BUILTIN_MATERIALS ${PROJECT_SOURCE_DIR}/scenes/transport/${name}.mtl)
endforeach()

add_custom_target(pertev_version BYPRODUCTS ${PERTEV_GENERATED_DIR}/version.cpp
  COMMAND ${CMAKE_COMMAND} -DSOURCE_DIR=${PROJECT_SOURCE_DIR} -DVERSION=${PROJECT_VERSION}
          -DOUTPUT=${PERTEV_GENERATED_DIR}/version.cpp -P ${PROJECT_SOURCE_DIR}/cmake/write_version.cmake
  COMMENT "Looking up the commit" VERBATIM)
target_sources(pertev_base PRIVATE ${PERTEV_GENERATED_DIR}/version.cpp)
add_dependencies(pertev_base pertev_version)

list(JOIN PERTEV_BUILTIN_SCENES "|" scene_files)
add_custom_command(OUTPUT ${PERTEV_GENERATED_DIR}/builtin_scenes.cpp
  DEPENDS ${PERTEV_BUILTIN_SCENES} ${PERTEV_BUILTIN_MATERIALS} ${PROJECT_SOURCE_DIR}/cmake/embed_scenes.cmake
          ${PROJECT_SOURCE_DIR}/cmake/builtin_scenes.cpp.in
  COMMAND ${CMAKE_COMMAND} "-DFILES=${scene_files}" -DOUTPUT=${PERTEV_GENERATED_DIR}/builtin_scenes.cpp
          -P ${PROJECT_SOURCE_DIR}/cmake/embed_scenes.cmake
  COMMENT "Embedding the built-in scenes" VERBATIM)
target_sources(pertev_formats PRIVATE ${PERTEV_GENERATED_DIR}/builtin_scenes.cpp)
