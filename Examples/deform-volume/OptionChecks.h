// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeOptionChecks_h
#define DeformVolumeOptionChecks_h

struct Options;

/// Throws a UsageError if options cannot be combined, or if a number or a name is not valid.
void CheckOptions(const Options& options);

/// Throws a UsageError if the resampler cannot be used with the deformation. isForwardField:
/// whether the deformation is a displacement field from the volume to the result.
void CheckResampler(const Options& options, bool isForwardField);

#endif
