# Sources that the build writes: the version (looked at in every build), the built-in scenes and the tables
# of lobes.

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

# The laboratory's page, and the tables of what is measured and of what other programs reached.
file(GLOB embedded_files CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/src/lab/page/* ${PROJECT_SOURCE_DIR}/bench/jobs.json
     ${PROJECT_SOURCE_DIR}/bench/figures.json)
list(JOIN embedded_files "|" embedded_list)
add_custom_command(OUTPUT ${PERTEV_GENERATED_DIR}/embedded_files.cpp
  DEPENDS ${embedded_files} ${PROJECT_SOURCE_DIR}/cmake/embed_files.cmake
  COMMAND ${CMAKE_COMMAND} "-DFILES=${embedded_list}" -DOUTPUT=${PERTEV_GENERATED_DIR}/embedded_files.cpp
          -P ${PROJECT_SOURCE_DIR}/cmake/embed_files.cmake
  COMMENT "Embedding the laboratory's page" VERBATIM)
pertev_embed(pertev_lab ${PERTEV_GENERATED_DIR}/embedded_files.cpp)

# Tables of lobes: half a minute of one core, once. Sums stand side by side for the vectoriser, which divides where masks say no.
add_executable(pertev_make_lobe_tables ${PROJECT_SOURCE_DIR}/tools/make_lobe_tables.cpp)
target_link_libraries(pertev_make_lobe_tables PRIVATE fmt::fmt TBB::tbb)
target_compile_options(pertev_make_lobe_tables PRIVATE -O3 -fno-trapping-math -fno-sanitize=all)
target_link_options(pertev_make_lobe_tables PRIVATE -fno-sanitize=all)
set_target_properties(pertev_make_lobe_tables PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${PERTEV_GENERATED_DIR})
set(lobes ${PERTEV_GENERATED_DIR}/shading/lobes)
file(MAKE_DIRECTORY ${lobes})
set(lobe_files energy_table_data.h sheen_table_data.h beckmann_table_data.h lobe_table_data.cpp metal_lost.inl metal_schlick.inl metal_average_lost.inl
    metal_average_schlick.inl glass_lost.inl glass_average_lost.inl albedo.inl beckmann_lost.inl beckmann_schlick.inl beckmann_average_lost.inl
    beckmann_glass_lost.inl beckmann_average_glass_lost.inl stretched_table_data.h stretched_lost.inl
    stretched_average_lost.inl stretched_beckmann_lost.inl stretched_beckmann_average_lost.inl
    coated_table_data.h returned_by_coat.inl stretched_glass_factor.inl stretched_glass_average.inl)
list(TRANSFORM lobe_files PREPEND ${lobes}/)
add_custom_command(OUTPUT ${lobe_files}
  DEPENDS pertev_make_lobe_tables COMMAND pertev_make_lobe_tables ${lobes} COMMENT "Integrating the tables of lobes" VERBATIM)
target_sources(pertev_shading PRIVATE ${lobe_files})
target_include_directories(pertev_shading PUBLIC $<BUILD_INTERFACE:${PERTEV_GENERATED_DIR}>)
