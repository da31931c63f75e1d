// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeMeshFormats_h
#define DeformVolumeMeshFormats_h

#include <string>

/// The formats of meshes (without those of displacement fields) and sheets: ".vtp, .stl, ...".
std::string GetMeshSuffixes();
std::string GetSheetSuffixes();

/// What to do with a mesh or a sheet in a format that is not read: the usual program that converts
/// it.
std::string GetMeshConversion(const std::string& path);
std::string GetSheetConversion(const std::string& path);

#endif
