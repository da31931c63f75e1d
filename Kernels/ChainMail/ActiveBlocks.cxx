// SPDX-License-Identifier: BSD-3-Clause
#include "ActiveBlocks.h"

#include <algorithm>

namespace deformvolume
{

ActiveBlocks::ActiveBlocks(const ChainMailBlocks& blocks)
  : Blocks(blocks)
  , Systems(blocks.GetNumberOfBlocks())
{
}

void ActiveBlocks::SetOrder(unsigned int order)
{
  this->IsShuffled = order != 0;
  this->Random.seed(order);
}

void ActiveBlocks::Add(std::uint32_t block, std::uint32_t systems)
{
  if (systems && !this->Systems[block])
  {
    this->Lists[static_cast<std::size_t>(this->Blocks.GetColor(block))].push_back(block);
  }
  this->Systems[block] = static_cast<unsigned char>(this->Systems[block] | systems);
}

void ActiveBlocks::AddNeighbors(std::uint32_t block, std::uint32_t faces, std::uint32_t systems)
{
  for (int face = 0; face < 6; ++face)
  {
    const std::int64_t neighbor = this->Blocks.GetNeighbor(block, face);
    if ((faces >> face & 1) && neighbor >= 0)
    {
      this->Add(static_cast<std::uint32_t>(neighbor), systems);
    }
  }
}

std::vector<ActiveBlock> ActiveBlocks::Take(int color, std::size_t most)
{
  std::vector<std::uint32_t>& blocks = this->Lists[static_cast<std::size_t>(color)];
  std::size_t kept = blocks.size() - std::min(blocks.size(), most);
  if (this->IsShuffled && !blocks.empty())
  {
    std::shuffle(blocks.begin(), blocks.end(), this->Random);
    kept = std::max(kept, static_cast<std::size_t>(this->Random() % blocks.size()));
  }
  std::vector<ActiveBlock> taken;
  taken.reserve(blocks.size() - kept);
  for (std::size_t i = kept; i < blocks.size(); ++i)
  {
    taken.push_back({ blocks[i], this->Systems[blocks[i]] });
    this->Systems[blocks[i]] = 0;
  }
  blocks.resize(kept);
  return taken;
}

void ActiveBlocks::Clear()
{
  for (std::vector<std::uint32_t>& blocks : this->Lists)
  {
    for (const std::uint32_t block : blocks)
    {
      this->Systems[block] = 0;
    }
    blocks.clear();
  }
}

} // namespace deformvolume
