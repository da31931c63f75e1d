// SPDX-License-Identifier: BSD-3-Clause
/**
 * Computes the default of the property Background Value in ParaView, by the same rule as in the
 * program deform-volume. In volumes with negative values, such as CT, 0 would look like tissue.
 */
#ifndef BackgroundDomain_h
#define BackgroundDomain_h

namespace deformvolume
{

/**
 * Registers the XML element BackgroundDomain. BackgroundDomain is a DoubleRangeDomain. Its default
 * value is the minimum of the active scalars of the required property Input, or of the first point
 * array if there are no active scalars. The default value is 0 if there is no array, if the type of
 * the array has no negative numbers, or if the array has several components.
 */
void RegisterBackgroundDomain();

} // namespace deformvolume

#endif
