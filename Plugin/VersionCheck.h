// SPDX-License-Identifier: BSD-3-Clause
/**
 * Tells the user when the running ParaView is not the one that this plugin was built for. ParaView
 * does not look by itself. Where the two differ so much that the plugin's libraries are not even
 * found, the loader of libraries says so, and this is never reached.
 */
#ifndef VersionCheck_h
#define VersionCheck_h

namespace deformvolume
{

/**
 * One error when the major or minor version differs, one warning when only the patch does.
 */
void CheckParaViewVersion();

} // namespace deformvolume

#endif
