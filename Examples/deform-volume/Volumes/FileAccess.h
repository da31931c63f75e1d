// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeFileAccess_h
#define DeformVolumeFileAccess_h

#include <string>

/// Returns why a file cannot be read, such as "there is no such file", or "" if it can be read.
std::string FindReadingFault(const std::string& path, bool canBeFolder = false);

#endif
