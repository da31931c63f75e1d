# SPDX-License-Identifier: BSD-3-Clause
# deformvolume_set_compile_options(<target>...): sets the compile options of all code of this project.

# Without contraction, results on the host are bitwise equal on CPUs with and without fused
# multiply-add. __FILE__, which messages of VTK and GoogleTest contain, is relative to the sources:
# otherwise, in a unity build, ccache does not find files that another clone has compiled.
set(DEFORMVOLUME_COMPILE_OPTIONS
  "$<$<COMPILE_LANG_AND_ID:CXX,GNU,Clang,AppleClang>:-Wall;-Wextra;-ffp-contract=off>"
  "$<$<COMPILE_LANG_AND_ID:CXX,GNU,Clang,AppleClang>:-fmacro-prefix-map=${PROJECT_SOURCE_DIR}/=>")

function (deformvolume_set_compile_options)
  foreach (target IN LISTS ARGN)
    target_compile_options("${target}" PRIVATE ${DEFORMVOLUME_COMPILE_OPTIONS})
  endforeach ()
endfunction ()

# deformvolume_optimize_less(<target>...): shortens the compilation of tests, which are fast enough
# with less optimization. With it, GCC warns wrongly of uninitialized variables.
function (deformvolume_optimize_less)
  foreach (target IN LISTS ARGN)
    target_compile_options("${target}" PRIVATE
      $<$<AND:$<CXX_COMPILER_ID:GNU,Clang,AppleClang>,$<NOT:$<CONFIG:Debug>>>:-O1;-g1>
      $<$<CXX_COMPILER_ID:GNU>:-Wno-maybe-uninitialized>)
  endforeach ()
endfunction ()

if (DEFORMVOLUME_SANITIZE)
  add_compile_options(
    -fsanitize=${DEFORMVOLUME_SANITIZE} -fno-sanitize-recover=all -fno-omit-frame-pointer)
  add_link_options(-fsanitize=${DEFORMVOLUME_SANITIZE})
endif ()
