// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeOptionChecks_h
#define DeformVolumeOptionChecks_h

struct Options;

/// Throws a UsageError where options do not go together, or a number or a name makes no sense.
void CheckOptions(const Options& options);

#endif
