// SPDX-License-Identifier: BSD-3-Clause
/**
 * Updates information properties, such as Summary, after each update of a filter. ParaView reads
 * them when a panel is opened and before Apply updates the pipeline, but not after an update.
 * Panels would therefore show device, counts and times of the previous update.
 *
 * The observers also make views show new output after a failed update, and reset properties to
 * their defaults if state files or scripts of former versions set them to values that were removed.
 */
#ifndef InformationRefresh_h
#define InformationRefresh_h

namespace deformvolume
{

/**
 * Adds the observers to the proxies and views of all present and future sessions of this client.
 * A second call has no effect.
 */
void ObserveSessions();

} // namespace deformvolume

#endif
