# SPDX-License-Identifier: BSD-3-Clause
# deformvolume_embed_sources(<target> <header> FILES <file>...)
#
# Compiles text files into a target. <header> declares a string for each file, in the namespace
# deformvolume. Its name is the file name, in which all characters except letters and digits are
# replaced by underscores (Resampling.cl: Resampling_cl).
#
# Each string consists of several raw literals of at most 8000 characters, which the compiler joins.

if (CMAKE_SCRIPT_MODE_FILE)
  file(READ "${input}" rest)
  set(literals "")
  while (NOT rest STREQUAL "")
    string(SUBSTRING "${rest}" 0 8000 part)
    string(LENGTH "${part}" length)
    string(SUBSTRING "${rest}" ${length} -1 rest)
    string(APPEND literals "\nR\"~~~~(${part})~~~~\"")
  endwhile ()
  file(WRITE "${output}"
    "#include \"${header}\"\nconst char* const deformvolume::${name} =${literals};\n")
  return ()
endif ()

set(DEFORMVOLUME_EMBED_SCRIPT "${CMAKE_CURRENT_LIST_FILE}")

function (deformvolume_embed_sources target header)
  cmake_parse_arguments(PARSE_ARGV 2 embed "" "" "FILES")
  string(MAKE_C_IDENTIFIER "${header}" guard)
  set(declarations "")
  foreach (file IN LISTS embed_FILES)
    cmake_path(ABSOLUTE_PATH file)
    cmake_path(GET file FILENAME name)
    string(MAKE_C_IDENTIFIER "${name}" name)
    set(output "${CMAKE_CURRENT_BINARY_DIR}/${name}.cxx")
    string(APPEND declarations "extern const char* const ${name};\n")
    add_custom_command(
      OUTPUT "${output}"
      COMMAND "${CMAKE_COMMAND}" "-Dinput=${file}" "-Doutput=${output}" "-Dname=${name}"
        "-Dheader=${header}" -P "${DEFORMVOLUME_EMBED_SCRIPT}"
      DEPENDS "${file}" "${DEFORMVOLUME_EMBED_SCRIPT}"
      COMMENT "Embedding ${name}"
      VERBATIM)
    target_sources("${target}" PRIVATE "${output}")
  endforeach ()
  file(CONFIGURE OUTPUT "${CMAKE_CURRENT_BINARY_DIR}/${header}" CONTENT
"#ifndef @guard@
#define @guard@
namespace deformvolume
{
@declarations@} // namespace deformvolume
#endif
" @ONLY)
  target_include_directories("${target}" PRIVATE "${CMAKE_CURRENT_BINARY_DIR}")
endfunction ()
