// SPDX-License-Identifier: BSD-3-Clause
/**
 * Chooses the first value of Background Value in ParaView, by the rule of the program
 * deform-volume. Where values of the volume can be negative, as those of CT, 0 is tissue.
 */
#ifndef BackgroundDomain_h
#define BackgroundDomain_h

namespace deformvolume
{

/**
 * Makes the element BackgroundDomain known to the XML of proxies. It is a DoubleRangeDomain whose
 * default value is the least value of the active scalars, or of the first point array, of the
 * required property Input. The default is 0 where there is no such array, where its type has no
 * negative numbers, and where it has several components.
 */
void RegisterBackgroundDomain();

} // namespace deformvolume

#endif
