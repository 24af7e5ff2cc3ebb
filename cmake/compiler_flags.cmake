# One set of arithmetic flags for every target. The one-picture law (docs/conventions.md) rests on them: with other ones in
# one target the linker might pick an inline function compiled to other arithmetic, so nothing here may differ between
# targets. How much a target is optimised may (apps/cli has -O1): it changes no bit.

set(PERTEV_ARITHMETIC_FLAGS -ffp-contract=off -fno-math-errno -march=x86-64-v3)
set(PERTEV_WARNING_FLAGS -Wall -Wextra -Wno-missing-field-initializers -Wpedantic -Wshadow -Wdouble-promotion -Wfloat-conversion)
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  # Optimiser's guesses about inlined library code, wrong on std::string (GCC bug 105651; through precompiled headers of
  # reads too), on members of std::optional and std::variant and, in GCC 13, on fmt.
  list(APPEND PERTEV_WARNING_FLAGS -Wno-restrict -Wno-array-bounds -Wno-stringop-overflow -Wno-stringop-overread -Wno-maybe-uninitialized)
endif()
if(PERTEV_WERROR)
  list(APPEND PERTEV_WARNING_FLAGS -Werror)
endif()
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  # g++ collects garbage from 128 MB on, which takes a tenth of the time of a unity file; the objects are the same.
  add_compile_options("$<$<COMPILE_LANGUAGE:CXX>:--param=ggc-min-heapsize=1048576>")
endif()

add_compile_options(
  "$<$<COMPILE_LANGUAGE:CXX>:${PERTEV_ARITHMETIC_FLAGS};${PERTEV_WARNING_FLAGS}>"
  "$<$<COMPILE_LANGUAGE:CUDA>:-fmad=false;-Xcompiler=-ffp-contract=off,-fno-math-errno,-march=x86-64-v3;-Xcompiler=-Wall,-Wextra;--expt-relaxed-constexpr;-Wno-deprecated-gpu-targets>")
if(PERTEV_WERROR)
  add_compile_options("$<$<COMPILE_LANGUAGE:CUDA>:-Werror=all-warnings;-Xcompiler=-Werror>")
endif()
add_compile_definitions($<$<STREQUAL:${PERTEV_THREADS},STD>:PERTEV_STD_THREADS>)

if(PERTEV_SANITIZE)
  add_compile_definitions(_GLIBCXX_ASSERTIONS)
  add_compile_options("$<$<COMPILE_LANGUAGE:CXX>:-fsanitize=${PERTEV_SANITIZE};-fno-sanitize-recover=all;-fno-omit-frame-pointer;-g1>")
  add_link_options(-fsanitize=${PERTEV_SANITIZE})
endif()

# pertev_compile_for_sixteen_lanes(FILE...): g++ compiles these files of the current folder for processors with AVX-512, which
# takes_sixteen_lanes() finds when the program runs. -fno-weak keeps their copies of inline functions to themselves; otherwise the
# linker might pick one for code that runs everywhere. g++ warns, for each constant of a header, that it is copied too, and has no
# name for that warning; the same code is compiled with all warnings for eight lanes.
function(pertev_compile_for_sixteen_lanes)
  set_source_files_properties(${ARGN} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON SKIP_PRECOMPILE_HEADERS ON)
  set_property(SOURCE ${ARGN} APPEND PROPERTY COMPILE_OPTIONS -march=x86-64-v4 -fno-weak -w)
endfunction()
