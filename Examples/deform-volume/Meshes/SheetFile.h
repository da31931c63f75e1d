// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeSheetFile_h
#define DeformVolumeSheetFile_h

#include <string>

/// Whether a binary STL file is truncated. VTK's reader reads such files without an error.
bool IsStlCutOff(const std::string& path);

/// Whether a PLY file is truncated, or has no valid header. VTK's reader crashes on such files.
bool IsPlyCutOff(const std::string& path);

#endif
