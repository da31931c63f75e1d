// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeMeshFormats_h
#define DeformVolumeMeshFormats_h

#include <string>

/// The file extensions of meshes (without those of displacement fields) and of sheets, such as
/// ".vtp, .stl".
std::string GetMeshSuffixes();
std::string GetSheetSuffixes();

/// Advice for a mesh or a sheet in a format that cannot be read: how to convert it.
std::string GetMeshConversion(const std::string& path);
std::string GetSheetConversion(const std::string& path);

#endif
