// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeRankSettings_h
#define DeformVolumeRankSettings_h

#include "Ranks.h"

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

class vtkAlgorithm;

namespace deformvolume
{

/// The settings of a filter on which the pieces of all ranks depend, and its connections. If they
/// differed, the pieces would not fit together, or a rank would wait for data that another one does
/// not send.
class RankSettings
{
public:
  /// Adds whether something is connected to an optional port. name: for a message, in lower case.
  void AddConnection(vtkAlgorithm* filter, int port, const std::string& name);
  /// Adds a setting. All ranks add the same names in the same order.
  void Add(const std::string& name, double value);
  void Add(const std::string& name, const std::string& value);
  template <std::size_t N>
  void Add(const std::string& name, const double (&values)[N])
  {
    std::string all;
    for (const double value : values)
    {
      all += Write(value) + " ";
    }
    this->Add(name, all);
  }

  /// Throws an Error that names the first difference, on all ranks, unless all have the same.
  /// Collective.
  void Check(const Ranks& ranks) const;

private:
  static std::string Write(double value);

  /// What the message on a difference says, and the value.
  std::vector<std::pair<std::string, std::string>> Values;
};

} // namespace deformvolume

#endif
