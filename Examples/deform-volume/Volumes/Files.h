// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeFiles_h
#define DeformVolumeFiles_h

#include <string>
#include <vector>

/// Whether a file name ends in one of the suffixes, in upper or lower case. suffixes: in lower
/// case.
bool HasSuffix(const std::string& path, const std::vector<const char*>& suffixes);

/// Returns a text without white space at its ends.
std::string Trim(const std::string& text);

/// Returns why a file cannot be read, such as "there is no such file", or "" if it can be read.
std::string FindReadingFault(const std::string& path, bool canBeFolder = false);

/// Throws a Failure if a file cannot be read.
void CheckReadable(const std::string& path, bool canBeFolder = false);

#endif
