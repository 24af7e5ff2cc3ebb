# pertev_module(FOLDER deps...): one static library from src/FOLDER, of all its .cpp and .cu files and instances. A .cu file is compiled
# as C++ where there is no CUDA; files under a folder named `cuda` are left out there.

function(pertev_compile_cuda_as_cxx)
  foreach(source IN LISTS ARGN)
    if(source MATCHES "\\.cu$")
      set_source_files_properties(${source} PROPERTIES LANGUAGE CXX COMPILE_OPTIONS "-xc++")
    endif()
  endforeach()
endfunction()

# Modules that need no speed are compiled by -O1, in two thirds of the time.
set(PERTEV_NEED_NO_SPEED pertev_settings pertev_session)

# Compiles once, for all C++ files, what most of them read: a third of the time of each file. Modules share what base
# has, or the first of those that need no speed, because g++ optimises a file as it did its precompiled headers. A target with
# headers of its own (ARGN) has its own.
function(pertev_precompile target)
  set(first pertev_base)
  if(target IN_LIST PERTEV_NEED_NO_SPEED AND CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    list(GET PERTEV_NEED_NO_SPEED 0 first)
    target_compile_options(${target} PRIVATE $<$<CONFIG:Release>:-O1>)
  endif()
  set(headers algorithm cmath filesystem functional map memory optional span string vector fmt/format.h ${ARGN})
  list(TRANSFORM headers REPLACE "(.+)" "$<$<COMPILE_LANGUAGE:CXX>:<\\1$<ANGLE-R>>")
  if(ARGN OR target STREQUAL first)
    target_precompile_headers(${target} PRIVATE ${headers})
  else()
    target_precompile_headers(${target} REUSE_FROM ${first})
  endif()
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    target_compile_options(${target} PRIVATE $<$<COMPILE_LANGUAGE:CXX>:-fpch-preprocess>) # for ccache
  endif()
endfunction()

option(PERTEV_UNITY "Compile up to 24 files of a module at once: a whole build takes far fewer core seconds" OFF)
function(pertev_unity target batch)
  set_target_properties(${target} PROPERTIES UNITY_BUILD ${PERTEV_UNITY} UNITY_BUILD_BATCH_SIZE ${batch})
endfunction()

option(PERTEV_FEW_KERNEL_FILES "With PERTEV_UNITY: compile up to 8 files with kernels at once, also those of shading, which makes a program smaller" OFF)

# Replaces the files of `list` by files of EXTENSION that include up to 24 of them each (for ptxas 4, because it has one
# core for a file), since most of the time that such a file takes goes into headers and into functions that they share. Each file
# with kernels of materials has 200 KB of tables for each architecture.
function(pertev_gather name extension list)
  set(batch 0)
  set(batch_size 24)
  if(extension STREQUAL "cu" AND NOT PERTEV_ONLY_CHECKS_KERNELS)
    set(batch_size 4)
    if(PERTEV_FEW_KERNEL_FILES)
      set(batch_size 8)
    endif()
  endif()
  set(files ${${list}})
  set(gathered_files "")
  while(files)
    list(SUBLIST files 0 ${batch_size} some)
    list(REMOVE_ITEM files ${some})
    set(text "")
    foreach(file IN LISTS some)
      # Text that does not depend on the tree's folder, for ccache.
      string(REGEX REPLACE "^(${PROJECT_SOURCE_DIR}/src|${PERTEV_GENERATED_DIR})/" "" file ${file})
      string(APPEND text "#include \"${file}\"\n")
    endforeach()
    set(gathered ${PROJECT_BINARY_DIR}/gathered/${name}_${batch}.${extension})
    file(CONFIGURE OUTPUT ${gathered} CONTENT "${text}" @ONLY)
    list(APPEND gathered_files ${gathered})
    math(EXPR batch "${batch} + 1")
  endwhile()
  set(${list} ${gathered_files} PARENT_SCOPE)
endfunction()

# Gathers .cu files of a list of sources, for nvcc or, without kernels, for the C++ compiler. nvcc takes a minute for each file of
# shading and of traversal. Those stay alone (but see PERTEV_FEW_KERNEL_FILES), and so do the files that every picture needs: a GPU is given all kernels of a
# file with the first of them. Folders above the clone may have any names.
function(pertev_gather_kernels name list)
  set(files ${${list}})
  list(FILTER files INCLUDE REGEX "\\.cu$|/cuda/[^/]*$")
  if(PERTEV_HAS_CUDA)
    set_source_files_properties(${files} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON) # CMake 3.31 and newer batch .cu files too
  endif()
  list(FILTER files EXCLUDE REGEX "/cuda/[^/]*$")
  set(extension cpp)
  if(PERTEV_COMPILES_KERNELS)
    set(extension cu)
    set(alone "shade_")
    if(PERTEV_FEW_KERNEL_FILES)
      set(alone "path/shade_(films|frames)\\.")
    endif()
    list(FILTER files EXCLUDE REGEX "/(${alone}|kernels/(lab/)?|hploc/|path_stages|film_stages|begin_and_trace)[^/]*$")
  elseif(PERTEV_HAS_CUDA)
    set_property(GLOBAL APPEND PROPERTY PERTEV_MODULES_WITH_KERNELS ${name})
    set_property(GLOBAL PROPERTY PERTEV_KERNELS_OF_${name} ${files})
  endif()
  if(PERTEV_UNITY)
    set_source_files_properties(${files} PROPERTIES HEADER_FILE_ONLY ON)
    set(traversals ${files})
    list(FILTER files EXCLUDE REGEX "/kernels/(lab/)?[^/]*$") # they have options of their own
    list(FILTER traversals INCLUDE REGEX "/kernels/(lab/)?[^/]*$")
    pertev_gather(${name} ${extension} files)
    pertev_gather(${name}_kernels ${extension} traversals)
    # A stage that a file launches beside its row would need no row except in builds with CUDA.
    set_source_files_properties(${files} ${traversals} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
    set(${list} ${${list}} ${files} ${traversals} PARENT_SCOPE)
  elseif(NOT PERTEV_COMPILES_KERNELS)
    pertev_compile_cuda_as_cxx(${files})
  endif()
endfunction()

# Where kernels are only checked: compiles those of all modules to PTX, which ptxas then reads (inline assembly is checked).
# Without optimisation that takes an eighth of the time.
function(pertev_check_kernels)
  if(NOT PERTEV_ONLY_CHECKS_KERNELS)
    return()
  endif()
  get_property(modules GLOBAL PROPERTY PERTEV_MODULES_WITH_KERNELS)
  foreach(name IN LISTS modules)
    get_property(files GLOBAL PROPERTY PERTEV_KERNELS_OF_${name})
    list(APPEND gathered ${files})
  endforeach()
  pertev_gather(kernels cu gathered)
  add_library(pertev_kernels OBJECT ${gathered})
  target_link_libraries(pertev_kernels PRIVATE pertev_lab) # for its include folders
  target_include_directories(pertev_kernels PRIVATE ${PROJECT_SOURCE_DIR})
  set_target_properties(pertev_kernels PROPERTIES CUDA_PTX_COMPILATION ON CUDA_ARCHITECTURES 90-virtual)
  if(CMAKE_CUDA_COMPILER_VERSION VERSION_GREATER_EQUAL 13.0)
    target_compile_options(pertev_kernels PRIVATE --Ofast-compile=max)
  endif()
endfunction()

# A folder within a module's may be a module too; it comes first.
function(pertev_module folder)
  set(dir ${PROJECT_SOURCE_DIR}/src/${folder})
  string(REPLACE "/" "_" name ${folder})
  file(GLOB_RECURSE sources CONFIGURE_DEPENDS ${dir}/*.cpp ${dir}/*.cu ${dir}/*.h)
  get_property(inner GLOBAL PROPERTY PERTEV_MODULE_FOLDERS)
  foreach(other IN LISTS inner)
    list(FILTER sources EXCLUDE REGEX "^${other}/")
  endforeach()
  set_property(GLOBAL APPEND PROPERTY PERTEV_MODULE_FOLDERS ${dir})
  if(NOT PERTEV_HAS_CUDA)
    list(FILTER sources EXCLUDE REGEX "/cuda/[^/]*$")
  endif()
  pertev_instances_of(${folder} "${inner}" instances)
  list(APPEND sources ${instances})
  pertev_gather_kernels(${name} sources)
  if(sources MATCHES "\\.(cpp|cu)(;|$)")
    add_library(pertev_${name} STATIC ${sources})
    target_include_directories(pertev_${name} PUBLIC $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/src>)
    target_link_libraries(pertev_${name} PUBLIC ${ARGN})
    pertev_precompile(pertev_${name})
    pertev_unity(pertev_${name} 24)
  else()
    add_library(pertev_${name} INTERFACE)
    target_include_directories(pertev_${name} INTERFACE $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/src>)
    target_link_libraries(pertev_${name} INTERFACE ${ARGN})
  endif()
endfunction()

# pertev_embed(TARGET FILE): compiles a generated FILE for TARGET by itself. A target that generates its own files is compiled
# only after all that it links, so that nothing of it were compiled beside ptxas.
function(pertev_embed target file)
  add_library(${target}_embedded OBJECT ${file})
  target_include_directories(${target}_embedded PRIVATE ${PROJECT_SOURCE_DIR}/src ${PROJECT_SOURCE_DIR}/apps ${PROJECT_SOURCE_DIR})
  target_sources(${target} PRIVATE $<TARGET_OBJECTS:${target}_embedded>)
endfunction()
