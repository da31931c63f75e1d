// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeNetcdfFile_h
#define DeformVolumeNetcdfFile_h

#include <string>

/// Whether a file is truncated. Recognizes netCDF's classic formats (CDF-1, CDF-2 and CDF-5), which
/// most Exodus files have. The netCDF library reads zeros from truncated files, without an error.
bool IsNetcdfCutOff(const std::string& path);

#endif
