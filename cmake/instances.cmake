# Files that instantiate templates and differ by types alone are written from rows (src/instances.cmake) when CMake configures.
# Each is compiled as if it lay in src: nvcc compiles files side by side, and a GPU is given all kernels of a file with the
# first of them.

set(PERTEV_GENERATED_DIR ${PROJECT_BINARY_DIR}/generated)

# pertev_instances(FILE INCLUDES text): FILE, from src on, of its module.
function(pertev_instances file includes text)
  set(lines "")
  foreach(include IN LISTS includes)
    string(APPEND lines "#include \"${include}\"\n")
  endforeach()
  set(path ${PERTEV_GENERATED_DIR}/${file})
  file(CONFIGURE OUTPUT ${path} CONTENT "${lines}\nnamespace pertev {\n${text}} // namespace pertev\n" @ONLY)
  set_property(GLOBAL APPEND PROPERTY PERTEV_INSTANCES ${path})
endfunction()

# pertev_launches(FILE header... STAGES stage...): device/launch.h for these stages.
function(pertev_launches file)
  cmake_parse_arguments(PARSE_ARGV 1 of "" "" "STAGES")
  set(text "")
  foreach(stage IN LISTS of_STAGES)
    string(APPEND text "template void launch(Queue&, const char*, WorkCount, const ${stage}&);\n")
  endforeach()
  pertev_instances(${file} "device/launch_body.h;${of_UNPARSED_ARGUMENTS}" "${text}")
endfunction()

# pertev_shading_kernels(NAME plain listeners row...): Shade for these masks of features, and the list of the masks as NAME in
# integrators/path/compiled_features.h. A row is "FILE: MASK", for shade_FILE.cu. Masks of kPlainDiffuse and kDiffuse,
# which they begin with, have the listeners `plain`.
function(pertev_shading_kernels name plain listeners)
  set(masks "")
  foreach(row IN LISTS ARGN)
    string(REGEX MATCH "^([a-z_]+): (.+)$" matched "${row}")
    set(file ${CMAKE_MATCH_1})
    set(mask ${CMAKE_MATCH_2})
    list(APPEND masks "${mask}")
    set(its_listeners ${listeners})
    if(mask MATCHES "^(kPlainDiffuse|kDiffuse)( |$)")
      set(its_listeners ${plain})
    endif()
    set_property(GLOBAL APPEND PROPERTY PERTEV_SHADING_FILES ${file})
    set_property(GLOBAL APPEND PROPERTY PERTEV_SHADING_${file} "Shade<${mask}, ${its_listeners}>")
  endforeach()
  list(JOIN masks ", " masks)
  set_property(GLOBAL APPEND_STRING PROPERTY PERTEV_SHADING_FEATURES "using ${name} = CompiledFor<${masks}>;\n")
endfunction()

# Writes the files of all rows of pertev_shading_kernels.
function(pertev_write_shading_kernels)
  get_property(features GLOBAL PROPERTY PERTEV_SHADING_FEATURES)
  file(CONFIGURE OUTPUT ${PERTEV_GENERATED_DIR}/integrators/path/compiled_features.h CONTENT
    "#pragma once\n\n#include \"integrators/path/path_job.h\"\n\nnamespace pertev {\n${features}} // namespace pertev\n" @ONLY)
  get_property(files GLOBAL PROPERTY PERTEV_SHADING_FILES)
  list(REMOVE_DUPLICATES files)
  foreach(file IN LISTS files)
    get_property(stages GLOBAL PROPERTY PERTEV_SHADING_${file})
    pertev_launches(integrators/path/shade_${file}.cu integrators/path/path_stages.h STAGES ${stages})
  endforeach()
endfunction()

# pertev_integrator(NAME header class): an integrator that is made of a machine of several.
function(pertev_integrator name header class)
  pertev_instances(integrators/${name}/${name}_integrator.cpp "integrators/${name}/${name}.h;${header}"
    "template class ${class};\n")
endfunction()

# pertev_host_shading(NAME listeners features): the CPU's shading with these listeners.
function(pertev_host_shading name listeners features)
  pertev_instances(integrators/path/shade_${name}.cpp integrators/path/host_shading_body.h "template <>
ShadeOnHost<${listeners}> shading_for<${listeners}>(const PathJob& job) {
    return choose_shading_on_host<${listeners}, ${features}>(job);
}
")
endfunction()

# pertev_lab_kernels(NAME header call...): add_NAME_kernels, which adds the rows of a traversal of the laboratory.
function(pertev_lab_kernels name header)
  set(text "void add_${name}_kernels(std::vector<TraversalKernel>& rows) {\n")
  foreach(call IN LISTS ARGN)
    string(APPEND text "    ${call};\n")
  endforeach()
  pertev_instances(tracer/kernels/lab/${name}.cu "${header};tracer/kernels/traversal_kernels_body.h" "${text}}\n")
endfunction()

# pertev_instances_of(FOLDER inner result): those of a folder of src, but not of the folders `inner` within it.
function(pertev_instances_of folder inner result)
  get_property(files GLOBAL PROPERTY PERTEV_INSTANCES)
  list(FILTER files INCLUDE REGEX "^${PERTEV_GENERATED_DIR}/${folder}/")
  foreach(other IN LISTS inner)
    string(REPLACE ${PROJECT_SOURCE_DIR}/src ${PERTEV_GENERATED_DIR} other ${other})
    list(FILTER files EXCLUDE REGEX "^${other}/")
  endforeach()
  set(${result} ${files} PARENT_SCOPE)
endfunction()
