// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeSheetFile_h
#define DeformVolumeSheetFile_h

#include <string>

/// Whether a binary STL file ends before its triangles do. VTK's reader gives those that are there.
bool IsStlCutOff(const std::string& path);

/// Whether a PLY file ends before its elements do, or has no header that says what they are. VTK's
/// reader crashes on such files.
bool IsPlyCutOff(const std::string& path);

#endif
