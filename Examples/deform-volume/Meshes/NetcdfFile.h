// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeNetcdfFile_h
#define DeformVolumeNetcdfFile_h

#include <string>

/// Whether a file in one of netCDF's classic formats (CDF-1, CDF-2 and CDF-5, in which most Exodus
/// files are) ends before its data do. The netCDF library gives zeros there, without an error.
bool IsNetcdfCutOff(const std::string& path);

#endif
