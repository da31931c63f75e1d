// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeFileSuffix_h
#define DeformVolumeFileSuffix_h

#include <initializer_list>
#include <string>

/// Whether a file name ends in one of the suffixes, in upper or lower case. suffixes: in lower
/// case.
bool HasSuffix(const std::string& path, std::initializer_list<const char*> suffixes);

#endif
