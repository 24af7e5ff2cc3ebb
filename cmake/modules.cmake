# pertev_module(NAME deps...): one static library from src/NAME, of all its .cpp and .cu files. A .cu file is compiled
# as C++ where there is no CUDA; files under a folder named `cuda` are left out there.

function(pertev_compile_cuda_as_cxx)
  foreach(source IN LISTS ARGN)
    if(source MATCHES "\\.cu$")
      set_source_files_properties(${source} PROPERTIES LANGUAGE CXX COMPILE_OPTIONS "-xc++")
    endif()
  endforeach()
endfunction()

# Compiles once for the target what most of its C++ files read: the standard library and fmt, and HEADERS besides. No
# header of ours is among them, and tools/check_headers.py holds each of those to what it includes itself.
function(pertev_precompile target)
  if(NOT PERTEV_PCH)
    return()
  endif()
  set(headers <algorithm> <array> <cmath> <cstdint> <filesystem> <functional> <map> <memory> <optional> <span> <string>
      <vector> <fmt/format.h> ${ARGN})
  list(TRANSFORM headers REPLACE "<(.+)>" "$<$<COMPILE_LANGUAGE:CXX>:<\\1$<ANGLE-R>>")
  target_precompile_headers(${target} PRIVATE ${headers})
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    target_compile_options(${target} PRIVATE $<$<COMPILE_LANGUAGE:CXX>:-fpch-preprocess>) # for ccache
  endif()
endfunction()

function(pertev_module name)
  set(dir ${PROJECT_SOURCE_DIR}/src/${name})
  file(GLOB_RECURSE sources CONFIGURE_DEPENDS ${dir}/*.cpp ${dir}/*.cu)
  file(GLOB_RECURSE headers CONFIGURE_DEPENDS ${dir}/*.h)
  if(NOT PERTEV_HAS_CUDA)
    list(FILTER sources EXCLUDE REGEX "/cuda/")
    pertev_compile_cuda_as_cxx(${sources})
  endif()
  if(sources)
    add_library(pertev_${name} STATIC ${sources} ${headers})
    target_include_directories(pertev_${name} PUBLIC ${PROJECT_SOURCE_DIR}/src)
    target_link_libraries(pertev_${name} PUBLIC ${ARGN})
  else()
    add_library(pertev_${name} INTERFACE)
    target_include_directories(pertev_${name} INTERFACE ${PROJECT_SOURCE_DIR}/src)
    target_link_libraries(pertev_${name} INTERFACE ${ARGN})
  endif()
endfunction()
