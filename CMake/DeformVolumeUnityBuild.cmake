# SPDX-License-Identifier: BSD-3-Clause
# deformvolume_unite_sources(<target> <count>): compiles up to <count> sources of one folder
# together, so that names in anonymous namespaces need only be unique within their folder.
#
# Call it in the directory of the target, after the last source was added. Sources of other
# directories, such as generated ones, are compiled alone.
function (deformvolume_unite_sources target count)
  get_target_property(sources "${target}" SOURCES)
  foreach (source IN LISTS sources)
    cmake_path(ABSOLUTE_PATH source)
    cmake_path(RELATIVE_PATH source BASE_DIRECTORY "${CMAKE_CURRENT_SOURCE_DIR}"
      OUTPUT_VARIABLE path)
    if (NOT path MATCHES "\\.cxx$" OR path MATCHES "^\\.\\./")
      continue ()
    endif ()
    cmake_path(GET path PARENT_PATH folder)
    if (NOT DEFINED "number_${folder}")
      set("number_${folder}" 0)
    endif ()
    math(EXPR group "${number_${folder}} / ${count}")
    math(EXPR "number_${folder}" "${number_${folder}} + 1")
    set_source_files_properties("${source}" PROPERTIES UNITY_GROUP "${folder}${group}")
  endforeach ()
  set_target_properties("${target}" PROPERTIES
    UNITY_BUILD "${DEFORMVOLUME_UNITY_BUILD}"
    UNITY_BUILD_MODE GROUP)
endfunction ()
