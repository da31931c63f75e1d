// SPDX-License-Identifier: BSD-3-Clause
#include "RankSettings.h"

#include "Hash.h"

#include "vtkAlgorithm.h"

#include <cstdint>
#include <sstream>

namespace deformvolume
{

void RankSettings::AddConnection(vtkAlgorithm* filter, int port, const std::string& name)
{
  this->Values.emplace_back("The " + name + " on input port " + std::to_string(port) +
      " is connected on some ranks only. Connect it on all ranks or on none. A rank without "
      "a part of a mesh connects an empty mesh.",
    filter->GetNumberOfInputConnections(port) > 0 ? "connected" : "");
}

void RankSettings::Add(const std::string& name, double value)
{
  this->Add(name, Write(value));
}

void RankSettings::Add(const std::string& name, const std::string& value)
{
  this->Values.emplace_back(
    name + " is not the same on all ranks. Set it to the same on all.", value);
}

void RankSettings::Check(const Ranks& ranks) const
{
  if (!ranks.AreMany())
  {
    return;
  }
  std::vector<std::uint64_t> hashes;
  for (const auto& [message, value] : this->Values)
  {
    hashes.push_back(HashOfNothing);
    AddToHash(hashes.back(), value.data(), value.size());
  }
  std::uint64_t all = HashOfNothing;
  AddToHash(all, hashes);
  if (ranks.AreEqual(all))
  {
    return;
  }
  for (std::size_t i = 0; i < hashes.size(); ++i)
  {
    if (!ranks.AreEqual(hashes[i]))
    {
      throw Error(this->Values[i].first);
    }
  }
}

std::string RankSettings::Write(double value)
{
  std::ostringstream text;
  text << std::hexfloat << value + 0.0; // -0.0 becomes 0.0, which equals it
  return text.str();
}

} // namespace deformvolume
