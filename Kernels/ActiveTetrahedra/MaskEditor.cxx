// SPDX-License-Identifier: BSD-3-Clause
#include "MaskEditor.h"

#include "BrickBlocks.h"
#include "Error.h"
#include "FiveTetrahedra.h"

#include <algorithm>
#include <bitset>
#include <cstring>
#include <iterator>
#include <string>
#include <utility>

namespace deformvolume
{
namespace
{

int CountBits(unsigned int byte)
{
  return static_cast<int>(std::bitset<8>(byte).count());
}

} // namespace

MaskEditor::MaskEditor(const Extent& vertices, float far)
  : Bricks(vertices)
  , Mask(this->Bricks.GetNumberOfCells(), DEFORMVOLUME_ALL_TETRAHEDRA)
  , Changed(this->Bricks.GetNumberOfBricks(), true)
  , Hits(0,
      [](unsigned char& hit, const unsigned char& other)
      { hit = static_cast<unsigned char>(hit | other); })
  , Distances(vertices, far)
  , Crossings(vertices)
{
  if (this->Mask.empty())
  {
    throw Error("The volume has no cells. Give it two voxels or more on each axis.");
  }
}

std::vector<std::size_t> MaskEditor::CompareBase(
  const unsigned char* base, const PointRanges& changes) const
{
  const auto differs = [&](std::size_t first, std::size_t end)
  { return std::memcmp(base + first, this->Base.data() + first, end - first) != 0; };
  const auto width = static_cast<std::size_t>(this->Bricks.GetSize()[0]);
  const auto height = static_cast<std::size_t>(this->Bricks.GetSize()[1]);
  std::vector<bool> isChanged(this->Changed.size());
  for (const std::array<std::size_t, 2>& range : changes)
  {
    // Compare row by row; in rows that differ, compare the part in each brick.
    const std::size_t rangeEnd = std::min(range[1], this->Mask.size());
    for (std::size_t row = range[0] / width; range[0] < rangeEnd && row * width < rangeEnd; ++row)
    {
      const std::size_t begin = std::max(row * width, range[0]);
      const std::size_t end = std::min((row + 1) * width, rangeEnd);
      for (std::size_t first = begin; first < end && differs(first, end);)
      {
        const std::size_t x = first - row * width;
        const std::size_t next = std::min(end, first - x % CellBricks::Length + CellBricks::Length);
        if (differs(first, next))
        {
          isChanged[this->Bricks.FindBrick({ { static_cast<int>(x), static_cast<int>(row % height),
            static_cast<int>(row / height) } })] = true;
        }
        first = next;
      }
    }
  }
  return TakeMarked(isChanged);
}

void MaskEditor::SetBase(const unsigned char* base, const PointRanges* changes)
{
  const std::size_t count = this->Mask.size();
  if (base && !this->Base.empty())
  {
    const std::vector<std::size_t> bricks =
      this->CompareBase(base, changes ? *changes : PointRanges{ { { 0, count } } });
    for (const std::size_t brick : bricks)
    {
      ForEachCell(this->Bricks, brick,
        [&](const std::array<int, 3>&, std::size_t, std::size_t cell)
        {
          this->NumberOfSwitchedOff -= CountBits(this->Base[cell] ^ this->Mask[cell]);
          this->Base[cell] = this->Mask[cell] = base[cell];
        });
    }
    this->Update(bricks);
    return;
  }
  if (base)
  {
    this->Base.assign(base, base + count);
    this->Mask = this->Base;
  }
  else
  {
    this->Base = std::vector<unsigned char>();
    this->Mask.assign(count, DEFORMVOLUME_ALL_TETRAHEDRA);
  }
  // The count was relative to the old base.
  this->NumberOfSwitchedOff = 0;
  this->Update(this->Edits);
  this->UpdateSwitchedOff();
  this->Changed.assign(this->Changed.size(), true);
}

void MaskEditor::SetBaseDistances(const float* base)
{
  this->Distances.SetBase(base, this->GetSets(&Edit::Distances));
}

void MaskEditor::SetBaseCut(const unsigned char* crossed, const float* distances)
{
  this->Crossings.SetBase(crossed, distances, this->GetSets(&Edit::Crossings));
  this->UpdateSwitchedOff();
}

void MaskEditor::UpdateSwitchedOff()
{
  const bool isAny = !this->Crossings.GetSwitchedOff().empty();
  for (std::size_t brick = 0; isAny && brick < this->Bricks.GetNumberOfBricks(); ++brick)
  {
    this->UpdateBrick(brick);
    this->Changed[brick] = true;
  }
}

std::uint64_t MaskEditor::Add(
  TetrahedronSet&& set, DistanceSet&& distances, CrossingSet&& crossings)
{
  if ((!crossings.IsEmpty() && crossings.Bricks.back() >= this->Bricks.GetNumberOfBricks()) ||
    (!set.IsEmpty() && set.Bricks.back() >= this->Bricks.GetNumberOfBricks()) ||
    (!distances.IsEmpty() &&
      distances.Bricks.back() >= this->Distances.GetBricks().GetNumberOfBricks()))
  {
    throw Error("An edit has bricks beyond the " +
      std::to_string(this->Bricks.GetNumberOfBricks()) +
      " bricks of the mask. Find the tetrahedra of an edit in the volume of the mask.");
  }
  this->Undone.clear();
  this->Edits.push_back(
    { ++this->LastNumber, std::move(set), std::move(distances), std::move(crossings) });
  this->Apply(this->Edits.back());
  return this->LastNumber;
}

bool MaskEditor::Remove(std::uint64_t edit)
{
  const auto isEdit = [edit](const Edit& other) { return other.Number == edit; };
  const auto undone = std::find_if(this->Undone.begin(), this->Undone.end(), isEdit);
  if (undone != this->Undone.end())
  {
    this->Undone.erase(undone);
    return true;
  }
  const auto found = std::find_if(this->Edits.begin(), this->Edits.end(), isEdit);
  if (found == this->Edits.end())
  {
    return false;
  }
  std::list<Edit> removed;
  removed.splice(removed.end(), this->Edits, found);
  this->Revert(removed.front());
  return true;
}

bool MaskEditor::Undo()
{
  if (this->Edits.empty())
  {
    return false;
  }
  this->Undone.splice(this->Undone.end(), this->Edits, std::prev(this->Edits.end()));
  this->Revert(this->Undone.back());
  return true;
}

bool MaskEditor::Redo()
{
  if (this->Undone.empty())
  {
    return false;
  }
  this->Edits.splice(this->Edits.end(), this->Undone, std::prev(this->Undone.end()));
  this->Apply(this->Edits.back());
  return true;
}

void MaskEditor::Reset()
{
  std::list<Edit> edits;
  edits.swap(this->Edits);
  this->Undone.clear();
  this->Hits.Clear();
  this->Update(edits);
  for (const Edit& edit : edits)
  {
    this->Distances.Update(edit.Distances.Bricks, {});
    this->Update(this->Crossings.Remove(edit.Crossings, {}));
  }
}

std::vector<std::size_t> MaskEditor::TakeChangedBricks()
{
  return TakeMarked(this->Changed);
}

bool MaskEditor::HasDistanceEdits() const
{
  return std::any_of(this->Edits.begin(), this->Edits.end(),
    [](const Edit& edit) { return !edit.Distances.IsEmpty(); });
}

bool MaskEditor::HasSmoothCuts() const
{
  return std::any_of(this->Edits.begin(), this->Edits.end(),
    [](const Edit& edit) { return !edit.Crossings.IsEmpty(); });
}

template <typename Set>
std::vector<const Set*> MaskEditor::GetSets(Set Edit::*set) const
{
  std::vector<const Set*> sets;
  for (const Edit& edit : this->Edits)
  {
    if (!(edit.*set).IsEmpty())
    {
      sets.push_back(&(edit.*set));
    }
  }
  return sets;
}

void MaskEditor::Apply(const Edit& edit)
{
  this->Hits.Add(edit.Set);
  this->Update(edit.Set.Bricks);
  this->Distances.Add(edit.Distances);
  this->Update(this->Crossings.Add(edit.Crossings));
}

void MaskEditor::Revert(const Edit& edit)
{
  this->Hits.Forget(edit.Set.Bricks);
  for (const Edit& other : this->Edits)
  {
    this->Hits.Rejoin(edit.Set.Bricks, other.Set);
  }
  this->Update(edit.Set.Bricks);
  this->Distances.Update(edit.Distances.Bricks, this->GetSets(&Edit::Distances));
  this->Update(this->Crossings.Remove(edit.Crossings, this->GetSets(&Edit::Crossings)));
}

void MaskEditor::Update(const std::vector<std::size_t>& bricks)
{
  for (const std::size_t brick : bricks)
  {
    this->UpdateBrick(brick);
    this->Changed[brick] = true;
  }
}

void MaskEditor::Update(const std::list<Edit>& edits)
{
  std::vector<bool> isHit(this->Changed.size());
  for (const Edit& edit : edits)
  {
    for (const std::size_t brick : edit.Set.Bricks)
    {
      isHit[brick] = true;
    }
  }
  this->Update(TakeMarked(isHit));
}

void MaskEditor::UpdateBrick(std::size_t brick)
{
  const TetrahedronSet::Block* const block = this->Hits.Find(brick);
  const std::vector<unsigned char>& off = this->Crossings.GetSwitchedOff();
  ForEachCell(this->Bricks, brick,
    [&](const std::array<int, 3>&, std::size_t index, std::size_t cell)
    {
      unsigned int hit = block ? (*block)[index] : 0U;
      hit |= off.empty() ? 0U : off[cell];
      const unsigned int base = this->Base.empty() ? DEFORMVOLUME_ALL_TETRAHEDRA : this->Base[cell];
      const unsigned int next = base & ~(hit & DEFORMVOLUME_ALL_TETRAHEDRA);
      this->NumberOfSwitchedOff += CountBits(base ^ next) - CountBits(base ^ this->Mask[cell]);
      this->Mask[cell] = static_cast<unsigned char>(next);
    });
}

} // namespace deformvolume
