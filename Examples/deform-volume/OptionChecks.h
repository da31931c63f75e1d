// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeOptionChecks_h
#define DeformVolumeOptionChecks_h

struct Options;

/// Throws a UsageError where options do not go together, or a number or a name makes no sense.
void CheckOptions(const Options& options);

/// Throws a UsageError where the resampler or the interpolation does not go with the deformation.
/// isForwardField: whether that is a displacement field that leads from the volume to the result.
void CheckResampler(const Options& options, bool isForwardField);

#endif
