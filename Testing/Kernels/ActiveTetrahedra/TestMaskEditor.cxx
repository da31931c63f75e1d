// SPDX-License-Identifier: BSD-3-Clause
// Masks after edits, undo and redo, compared with copies of whole masks.
#include "CuttingReference.h"
#include "Error.h"
#include "MaskEditor.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <random>
#include <set>
#include <vector>

using namespace deformvolume;

namespace
{

struct Edit
{
  std::uint64_t Number;
  reference::Mask Hits;
};

TetrahedronSet MakeSet(std::mt19937& random, const CellBricks& bricks)
{
  TetrahedronSet set;
  for (std::size_t brick = 0; brick < bricks.GetNumberOfBricks(); ++brick)
  {
    if (random() % 3)
    {
      continue;
    }
    set.Bricks.push_back(brick);
    set.Blocks.emplace_back();
    for (unsigned char& byte : set.Blocks.back())
    {
      byte = static_cast<unsigned char>(random() % 4 ? 0 : random() % 32);
    }
  }
  return set;
}

// Computes the mask after edits from the original mask.
reference::Mask Apply(const reference::Mask& base, const std::vector<Edit>& edits)
{
  reference::Mask mask = base;
  for (const Edit& edit : edits)
  {
    for (std::size_t i = 0; i < mask.size(); ++i)
    {
      mask[i] = static_cast<unsigned char>(mask[i] & ~edit.Hits[i]);
    }
  }
  return mask;
}

// Changes some ranges of a mask, and returns these ranges.
PointRanges ChangeSome(std::mt19937& random, reference::Mask& mask)
{
  PointRanges ranges(random() % 4);
  for (std::array<std::size_t, 2>& range : ranges)
  {
    range[0] = random() % mask.size();
    range[1] = std::min(mask.size(), range[0] + random() % 60);
    std::for_each(mask.begin() + static_cast<std::ptrdiff_t>(range[0]),
      mask.begin() + static_cast<std::ptrdiff_t>(range[1]),
      [&](unsigned char& byte)
      { byte = random() % 3 ? byte : static_cast<unsigned char>(random()); });
  }
  return ranges;
}

// The bricks in which two masks differ.
std::vector<std::size_t> FindDifferent(
  const CellBricks& bricks, const reference::Mask& a, const reference::Mask& b)
{
  const std::array<int, 3>& size = bricks.GetSize();
  std::set<std::size_t> found;
  for (std::size_t i = 0; i < a.size(); ++i)
  {
    if (a[i] != b[i])
    {
      const int cell = static_cast<int>(i);
      found.insert(bricks.FindBrick(
        { { cell % size[0], cell / size[0] % size[1], cell / size[0] / size[1] } }));
    }
  }
  return { found.begin(), found.end() };
}

int CountActive(reference::Mask mask)
{
  for (unsigned char& byte : mask)
  {
    byte = byte & 31;
  }
  return reference::Count(mask);
}

} // namespace

TEST(MaskEditor, MisuseIsAnError)
{
  EXPECT_THROW(MaskEditor(Extent{ { 0, 5, 0, 5, 3, 3 } }), Error);
  EXPECT_THROW(MaskEditor{ EmptyExtent }, Error);
  MaskEditor editor(Extent{ { 0, 8, 0, 8, 0, 9 } });
  EXPECT_FALSE(editor.Undo());
  EXPECT_FALSE(editor.Redo());
  EXPECT_FALSE(editor.Remove(1));
  TetrahedronSet wrong;
  wrong.Bricks = { 2 };
  wrong.Blocks.resize(1);
  EXPECT_THROW(editor.Add(std::move(wrong)), Error);
  editor.Reset();
  EXPECT_EQ(editor.GetMask(), reference::Mask(8 * 8 * 9, 31));
  EXPECT_EQ(editor.GetNumberOfSwitchedOffTetrahedra(), 0);
  // A set without tetrahedra is a valid edit.
  editor.Add({});
  EXPECT_TRUE(editor.Undo());
  EXPECT_TRUE(editor.Redo());
}

// 10,000 updates of one tool. The last update handles no more bricks than the first one, and all
// updates together have the effect of a single edit.
TEST(MaskEditor, WorkDoesNotGrowWithTheNumberOfEdits)
{
  const Extent vertices{ { 0, 16, 0, 8, 0, 8 } };
  MaskEditor editor(vertices);
  MaskEditor other(vertices);
  std::mt19937 random(4);
  TetrahedronSet all;
  all.Bricks = std::vector<std::size_t>{ 0, 1 };
  all.Blocks.resize(2);
  for (int edit = 0; edit < 10000; ++edit)
  {
    TetrahedronSet set;
    set.Bricks = std::vector<std::size_t>{ 0, 1 };
    set.Blocks.resize(2);
    CrossingSet crossings;
    crossings.Bricks.push_back(1);
    crossings.Blocks.resize(1);
    for (std::size_t brick = 0; brick < 2; ++brick)
    {
      const std::size_t cell = random() % 512;
      set.Blocks[brick][cell] = static_cast<unsigned char>(random() % 32);
      all.Blocks[brick][cell] |= set.Blocks[brick][cell];
    }
    crossings.Blocks[0][random() % 512].Edges = 1;
    const std::uint64_t before = editor.GetNumberOfJoins();
    editor.Add(std::move(set), {}, edit % 2 ? CrossingSet() : std::move(crossings));
    ASSERT_EQ(editor.GetNumberOfJoins() - before, edit % 2 ? 2U : 3U);
  }
  other.Add(std::move(all));
  EXPECT_EQ(editor.GetNumberOfEdits(), 10000U);
  // Tetrahedra with an edge that several edits cross are switched off, too.
  for (std::size_t cell = 0; cell < other.GetMask().size(); ++cell)
  {
    ASSERT_EQ(editor.GetMask()[cell],
      other.GetMask()[cell] & ~editor.GetSmoothCrossings().GetSwitchedOff()[cell]);
  }
}

TEST(MaskEditor, HistoriesEqualTheReference)
{
  std::mt19937 random(10);
  for (int round = 0; round < 60; ++round)
  {
    const Extent vertices{ { -2, 15 + round % 7, 1, 18, 0, 4 + round % 9 } };
    MaskEditor editor(vertices);
    reference::Mask base(editor.GetMask().size(), 31);
    std::vector<Edit> edits;
    std::vector<Edit> undone;
    reference::Mask copy;
    bool hasBase = false;
    EXPECT_EQ(editor.TakeChangedBricks().size(), editor.GetBricks().GetNumberOfBricks());
    copy = editor.GetMask();
    for (int step = 0; step < 200; ++step)
    {
      const unsigned int choice = random() % 18;
      const reference::Mask before = base;
      std::vector<std::size_t> changed; // requested for this step only
      if (choice < 5)
      {
        TetrahedronSet set = MakeSet(random, editor.GetBricks());
        reference::Mask hits = reference::GetMask(editor.GetBricks(), set);
        edits.push_back({ editor.Add(std::move(set)), std::move(hits) });
        undone.clear();
      }
      else if (choice < 9)
      {
        ASSERT_EQ(editor.Undo(), !edits.empty());
        if (!edits.empty())
        {
          undone.push_back(edits.back());
          edits.pop_back();
        }
      }
      else if (choice < 12)
      {
        ASSERT_EQ(editor.Redo(), !undone.empty());
        if (!undone.empty())
        {
          edits.push_back(undone.back());
          undone.pop_back();
        }
      }
      else if (choice < 14)
      {
        std::vector<Edit>& list = choice == 12 ? edits : undone;
        if (!list.empty())
        {
          const auto edit = list.begin() + static_cast<std::ptrdiff_t>(random() % list.size());
          ASSERT_TRUE(editor.Remove(edit->Number));
          ASSERT_FALSE(editor.Remove(edit->Number));
          list.erase(edit);
        }
      }
      else if (choice == 14 && step % 5 == 0)
      {
        editor.Reset();
        edits.clear();
        undone.clear();
      }
      else if (choice == 15)
      {
        const bool isPlain = random() % 3 == 0;
        std::generate(base.begin(), base.end(),
          [&] { return static_cast<unsigned char>(isPlain ? 31 : random()); });
        editor.SetBase(isPlain ? nullptr : base.data());
        hasBase = !isPlain;
      }
      else if (hasBase)
      {
        const bool isTold = random() % 2 == 0;
        const PointRanges ranges = ChangeSome(random, base);
        const std::vector<std::size_t> expected = FindDifferent(editor.GetBricks(), base, before);
        editor.SetBase(base.data(), isTold ? &ranges : nullptr);
        changed = editor.TakeChangedBricks();
        ASSERT_EQ(changed, expected) << "round " << round << ", step " << step;
      }
      const reference::Mask expected = Apply(base, edits);
      ASSERT_EQ(editor.GetMask(), expected) << "round " << round << ", step " << step;
      ASSERT_EQ(
        editor.GetNumberOfSwitchedOffTetrahedra(), CountActive(base) - CountActive(expected));
      ASSERT_EQ(editor.GetNumberOfEdits(), edits.size());
      ASSERT_EQ(editor.GetNumberOfUndoneEdits(), undone.size());
      // All changes lie in the bricks that the editor reports.
      const std::vector<std::size_t> others = editor.TakeChangedBricks();
      changed.insert(changed.end(), others.begin(), others.end());
      for (const std::size_t brick : changed)
      {
        const Extent cells = editor.GetBricks().GetCells(brick);
        const auto& size = editor.GetBricks().GetSize();
        for (int z = cells[4]; z <= cells[5]; ++z)
        {
          for (int y = cells[2]; y <= cells[3]; ++y)
          {
            for (int x = cells[0]; x <= cells[1]; ++x)
            {
              const auto cell = static_cast<std::size_t>((z * size[1] + y) * size[0] + x);
              copy[cell] = editor.GetMask()[cell];
            }
          }
        }
      }
      ASSERT_EQ(copy, expected);
      ASSERT_TRUE(editor.TakeChangedBricks().empty());
    }
    // Undo all edits: the original mask is restored bit for bit.
    while (editor.Undo())
    {
    }
    EXPECT_EQ(editor.GetMask(), base);
    EXPECT_EQ(editor.GetNumberOfSwitchedOffTetrahedra(), 0);
  }
}
