// SPDX-License-Identifier: BSD-3-Clause
// No test. Compares ordinary schemes of ChainMail with ChainMailModel on two cubes of 48 x 48 x 48
// voxels. Prints the table of Documents/chainmail.md.
#include "ChainMailModel.h"
#include "ChainMailReference.h"

#include <algorithm>
#include <cstdio>
#include <deque>
#include <vector>

using namespace deformvolume;

namespace
{

constexpr int Size = 48;
constexpr Extent Cube{ { 0, Size - 1, 0, Size - 1, 0, Size - 1 } };
constexpr double Drag[3] = { 6, 2, 0 };
constexpr std::size_t MostPops = 20000000;

// A link to another voxel. More, Less: how much greater and smaller the displacement of that voxel
// may be.
struct Way
{
  std::size_t To;
  double More[3];
  double Less[3];
};

class Net
{
public:
  explicit Net(const ChainMailReference& reference)
    : Reference(reference)
    , Ways(reference.GetNumberOfVoxels())
    , Displacements(3 * reference.GetNumberOfVoxels())
    , Handle(reference.GetVoxel(Size / 2, Size / 2, Size / 2))
  {
    for (const ReferenceLink& link : reference.GetLinks())
    {
      Way there{ link.Second, {}, {} };
      Way back{ link.First, {}, {} };
      for (int c = 0; c < 3; ++c)
      {
        const auto limits = reference.GetLimits(link, c);
        there.More[c] = back.Less[c] = static_cast<double>(limits[0]) / 65536.0;
        there.Less[c] = back.More[c] = static_cast<double>(limits[1]) / 65536.0;
      }
      this->Ways[link.First].push_back(there);
      this->Ways[link.Second].push_back(back);
    }
    std::copy(Drag, Drag + 3, &this->Displacements[3 * this->Handle]);
  }

  // Moves the voxel at the end of a link to the limits of the link. Returns whether this changes
  // its displacement.
  bool Follow(std::size_t from, const Way& way)
  {
    bool moves = false;
    for (std::size_t c = 0; c < 3; ++c)
    {
      double& x = this->Displacements[3 * way.To + c];
      const double sponsor = this->Displacements[3 * from + c];
      const double next = std::clamp(x, sponsor - way.Less[c], sponsor + way.More[c]);
      moves = moves || next != x;
      x = next;
    }
    return moves;
  }

  double GetViolation() const
  {
    return this->Reference.GetViolation(
      std::vector<float>(this->Displacements.begin(), this->Displacements.end()));
  }

  const ChainMailReference& Reference;
  std::vector<std::vector<Way>> Ways;
  std::vector<double> Displacements;
  std::size_t Handle;
};

// A first-in, first-out queue. A voxel that has moved is the sponsor of its neighbors: they are
// compared with no other voxel.
void RunQueue(const ChainMailReference& reference, bool onlyOnce)
{
  Net net(reference);
  struct Entry
  {
    std::size_t From;
    const Way* To;
  };
  std::deque<Entry> queue;
  std::vector<char> isDone(reference.GetNumberOfVoxels());
  isDone[net.Handle] = 1;
  for (const Way& way : net.Ways[net.Handle])
  {
    queue.push_back({ net.Handle, &way });
  }
  std::size_t pops = 0;
  for (; !queue.empty() && pops < MostPops; ++pops)
  {
    const Entry entry = queue.front();
    queue.pop_front();
    const std::size_t voxel = entry.To->To;
    if (voxel == net.Handle || (onlyOnce && isDone[voxel]))
    {
      continue;
    }
    isDone[voxel] = 1;
    if (net.Follow(entry.From, *entry.To))
    {
      for (const Way& way : net.Ways[voxel])
      {
        if (way.To != entry.From)
        {
          queue.push_back({ voxel, &way });
        }
      }
    }
  }
  std::printf("| %s | %zu pops%s | %.3f |\n",
    onlyOnce ? "queue, each voxel once" : "queue, until it is empty", pops,
    queue.empty() ? "" : ", not empty", net.GetViolation());
}

// All voxels at once are moved into the limits of their neighbors that have moved.
void RunClamping(const ChainMailReference& reference, int sweeps)
{
  Net net(reference);
  std::vector<char> hasMoved(reference.GetNumberOfVoxels());
  hasMoved[net.Handle] = 1;
  int sweep = 0;
  for (bool changed = true; changed && sweep < sweeps; ++sweep)
  {
    changed = false;
    std::vector<double> next = net.Displacements;
    std::vector<char> moved = hasMoved;
    for (std::size_t voxel = 0; voxel < net.Ways.size(); ++voxel)
    {
      for (std::size_t c = 0; c < 3 && voxel != net.Handle; ++c)
      {
        double& x = next[3 * voxel + c];
        const double before = x;
        for (const Way& way : net.Ways[voxel])
        {
          if (hasMoved[way.To])
          {
            const double other = net.Displacements[3 * way.To + c];
            x = std::clamp(x, other - way.More[c], other + way.Less[c]);
          }
        }
        if (x != before)
        {
          changed = true;
          moved[voxel] = 1;
        }
      }
    }
    net.Displacements = next;
    hasMoved = moved;
  }
  std::printf("| all voxels at once | %d sweeps | %.3f |\n", sweep, net.GetViolation());
}

void RunModel(const ChainMailReference& reference)
{
  ChainMailModel model;
  model.SetVoxelGrid(Cube);
  model.SetMaterials(reference.Table, reference.Materials.data());
  std::vector<float> output(3 * reference.GetNumberOfVoxels());
  model.SetOutput(output.data());
  ChainMailRequest request;
  request.Handles.resize(1);
  request.Handles[0].RestPosition = { { Size / 2, Size / 2, Size / 2 } };
  request.Handles[0].Displacement = { { Drag[0], Drag[1], Drag[2] } };
  const ChainMailReport report = model.Step(request);
  std::printf("| `ChainMailModel` | %lld rounds over blocks, %lld voxels moved | %.3f |\n",
    static_cast<long long>(report.NumberOfSweeps),
    static_cast<long long>(report.NumberOfMovedVoxels), reference.GetViolation(output));
}

void Run(const char* name, const ChainMailReference& reference)
{
  std::printf("\n%s\n\n| scheme | work | largest violation, in voxels |\n|---|---|---|\n", name);
  RunQueue(reference, true);
  RunQueue(reference, false);
  RunClamping(reference, 1000);
  RunModel(reference);
}

} // namespace

int main()
{
  ChainMailReference soft(Cube, { { 1, 1, 1 } });
  Run("soft tissue", soft);
  ChainMailReference mixed(Cube, { { 1, 1, 1 } });
  mixed.Table = { { 0.5, 1.5, 0.5 }, { 0.8, 1.2, 0.2 }, { 0.95, 1.05, 0.05 } };
  for (int k = 0; k < Size; ++k)
  {
    for (int j = 0; j < Size; ++j)
    {
      for (int i = 0; i < Size; ++i)
      {
        const int square = (i - 32) * (i - 32) + (j - 24) * (j - 24) + (k - 24) * (k - 24);
        mixed.Materials[mixed.GetVoxel(i, j, k)] = static_cast<unsigned char>(square < 36 ? 2
            : (j / 4) % 3 == 0                                                            ? 1
                                                                                          : 0);
      }
    }
  }
  Run("soft tissue with stripes of muscle and a ball of cartilage", mixed);
  return 0;
}
