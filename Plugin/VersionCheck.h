// SPDX-License-Identifier: BSD-3-Clause
/**
 * Checks whether the plugin was built for the version of the running ParaView, which ParaView
 * itself does not check. If the versions differ so much that the libraries of the plugin cannot be
 * loaded, the dynamic loader reports an error, and this check does not run.
 */
#ifndef VersionCheck_h
#define VersionCheck_h

namespace deformvolume
{

/**
 * Reports an error if the major or minor version differs, and a warning if only the patch version
 * differs.
 */
void CheckParaViewVersion();

} // namespace deformvolume

#endif
