// SPDX-License-Identifier: BSD-3-Clause
/**
 * Keeps what the panels tell of the last update up to date. ParaView fetches properties of
 * information when a panel is opened and before Apply updates the pipeline, but not after an
 * update: device, counts and times would be those of the update before. Views show what changes
 * after an update that has failed. Proxies forget properties of former versions that state files
 * and scripts have set.
 */
#ifndef InformationRefresh_h
#define InformationRefresh_h

namespace deformvolume
{

/**
 * From now on, proxies of this plugin's classes fetch their information after each update, and
 * views end each update, in all sessions of this client. A second call changes nothing.
 */
void RefreshInformation();

} // namespace deformvolume

#endif
