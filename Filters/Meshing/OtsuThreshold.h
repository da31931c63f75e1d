// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeOtsuThreshold_h
#define DeformVolumeOtsuThreshold_h

#include <cstddef>
#include <vector>

namespace deformvolume
{

/// Otsu, "A threshold selection method from gray-level histograms", 1979: returns the number of
/// bins below the threshold at which the variance between the two classes is greatest. If several
/// thresholds have that variance, returns the mean of the first and the last.
inline double FindOtsuThreshold(const std::vector<double>& counts)
{
  double total = 0.0;
  double moment = 0.0;
  for (std::size_t i = 0; i < counts.size(); ++i)
  {
    total += counts[i];
    moment += static_cast<double>(i) * counts[i];
  }
  double below = 0.0;
  double momentBelow = 0.0;
  double best = -1.0;
  std::size_t first = 0;
  std::size_t last = 0;
  for (std::size_t i = 0; i + 1 < counts.size(); ++i)
  {
    below += counts[i];
    momentBelow += static_cast<double>(i) * counts[i];
    const double above = total - below;
    if (below == 0.0 || above == 0.0)
    {
      continue;
    }
    const double difference = momentBelow / below - (moment - momentBelow) / above;
    const double between = below * above * difference * difference;
    if (between > best * (1.0 + 1e-12))
    {
      best = between;
      first = i + 1;
    }
    if (between >= best * (1.0 - 1e-12))
    {
      last = i + 1;
    }
  }
  return 0.5 * static_cast<double>(first + last);
}

} // namespace deformvolume

#endif
