# SPDX-License-Identifier: BSD-3-Clause
# The target DeformVolumeReference generates the reference of the public headers in
# <build>/Reference. Documents/Doxyfile.in has the settings; Documents.Reference is the test.
find_program(DOXYGEN_EXECUTABLE doxygen)
mark_as_advanced(DOXYGEN_EXECUTABLE)

set(deformvolume_reference "${PROJECT_BINARY_DIR}/Reference")
set(deformvolume_doxyfile "${PROJECT_BINARY_DIR}/Doxyfile")
# All classes are documented, independently of the VTK of this build.
file(GLOB deformvolume_classes CONFIGURE_DEPENDS
  "${PROJECT_SOURCE_DIR}/Filters/vtk*.h"
  "${PROJECT_SOURCE_DIR}/Interaction/vtk*.h")
list(FILTER deformvolume_classes EXCLUDE REGEX "Internals\\.h$")
get_target_property(deformvolume_engine DeformVolumeKernels HEADER_SET)
list(FILTER deformvolume_engine EXCLUDE REGEX "/DeformVolumeExport\\.h$")
get_target_property(deformvolume_c DeformVolumeC HEADER_SET)
set(deformvolume_reference_input
  "${PROJECT_SOURCE_DIR}/Documents/reference.md"
  ${deformvolume_classes} ${deformvolume_engine} ${deformvolume_c})
list(TRANSFORM deformvolume_reference_input REPLACE "(.+)" "\"\\1\"")
list(JOIN deformvolume_reference_input " \\\n  " deformvolume_reference_input)
configure_file("${PROJECT_SOURCE_DIR}/Documents/Doxyfile.in" "${deformvolume_doxyfile}" @ONLY)

if (DOXYGEN_EXECUTABLE)
  add_custom_target(DeformVolumeReference
    COMMAND "${DOXYGEN_EXECUTABLE}" "${deformvolume_doxyfile}"
    COMMENT "Making the reference in ${deformvolume_reference}"
    VERBATIM)
endif ()
