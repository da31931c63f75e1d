// SPDX-License-Identifier: BSD-3-Clause
#include "MeshGathering.h"

#include "CellReader.h"
#include "CoincidentPoints.h"
#include "Hash.h"
#include "MeshCells.h"
#include "MeshStamp.h"
#include "RestMesh.h"

#include "vtkCellArray.h"
#include "vtkCellType.h"
#include "vtkDoubleArray.h"
#include "vtkIdTypeArray.h"
#include "vtkImageData.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkUnstructuredGrid.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <limits>
#include <utility>

namespace deformvolume
{

namespace
{

Stamp GetPieceStamp(const DeformationSource& source)
{
  Stamp stamp;
  for (const MeshParts* parts : { &source.ShapeParts, &source.RestParts })
  {
    for (const Stamp& part :
      { GetCellArraysStamp(*parts), GetPointsStamp(*parts), GetPointVectorsStamp(*parts) })
    {
      stamp.insert(stamp.end(), part.begin(), part.end());
    }
  }
  stamp.emplace_back(source.Shape, 0);
  stamp.emplace_back(source.Rest, 0);
  return stamp;
}

template <typename T>
void GatherVector(const Ranks& ranks, std::vector<T>& values, const std::string& what)
{
  const std::vector<char> all = ranks.Gather(values.data(), values.size() * sizeof(T), what);
  ranks.Attempt([&] { values.resize(all.size() / sizeof(T)); });
  if (!all.empty())
  {
    std::memcpy(static_cast<void*>(values.data()), all.data(), all.size());
  }
}

vtkSmartPointer<vtkDoubleArray> MakeArray(const std::vector<glm::dvec3>& vectors)
{
  const auto array = vtkSmartPointer<vtkDoubleArray>::New();
  array->SetNumberOfComponents(3);
  array->SetNumberOfTuples(static_cast<vtkIdType>(vectors.size()));
  if (!vectors.empty())
  {
    std::memcpy(array->GetPointer(0), vectors.data(), vectors.size() * sizeof(glm::dvec3));
  }
  return array;
}

// Whether a piece has other cells than tetrahedra.
bool HasOtherCells(const MeshParts& parts)
{
  for (vtkUnstructuredGrid* grid : parts)
  {
    for (vtkIdType cell = 0; cell < grid->GetNumberOfCells(); ++cell)
    {
      if (grid->GetCellType(cell) != VTK_TETRA)
      {
        return true;
      }
    }
  }
  return false;
}

// Returns the sum over the ranks before this one, and the sum over all ranks. Collective.
std::array<std::uint64_t, 2> Count(const Ranks& ranks, std::size_t mine)
{
  std::array<std::uint64_t, 2> counts{};
  const std::vector<std::uint64_t> numbers = ranks.Gather(mine);
  for (int rank = 0; rank < ranks.GetCount(); ++rank)
  {
    counts[0] += rank < ranks.GetRank() ? numbers[rank] : 0;
    counts[1] += numbers[rank];
  }
  return counts;
}

// Returns CellNode::Place of each node of this rank's piece, so that cells of different ranks split
// a common face alike. Collective.
std::vector<std::int32_t> FindPlaces(const Ranks& ranks, const MeshParts& parts)
{
  std::vector<glm::dvec3> points;
  ranks.Attempt(
    [&]
    {
      for (vtkUnstructuredGrid* grid : parts)
      {
        for (vtkIdType id = 0; id < grid->GetNumberOfPoints(); ++id)
        {
          points.emplace_back();
          grid->GetPoint(id, &points.back().x);
        }
      }
    });
  const std::size_t mine = points.size();
  const auto first = static_cast<std::ptrdiff_t>(Count(ranks, mine)[0]);
  GatherVector(ranks, points, MESH_NAME);
  std::vector<std::int32_t> places;
  ranks.Attempt(
    [&]
    {
      const std::vector<std::int32_t> all = FindCoincidentPoints(points);
      places.assign(all.begin() + first, all.begin() + first + static_cast<std::ptrdiff_t>(mine));
    });
  return places;
}

// Lets tetrahedra of different ranks use the same node where each rank has a copy of it. Copies
// have the same position at rest and the same vector; nodes with different vectors are a split that
// has opened. Nodes of one rank are left as they are, as in one process. No node is removed, so
// that a split which opens later changes tetrahedra only. ranks: the rank of each node.
void JoinCopies(std::vector<Tetrahedron>& tetrahedra, const std::vector<glm::dvec3>& restPoints,
  const std::vector<glm::dvec3>& vectors, const std::vector<int>& ranks)
{
  const std::vector<std::int32_t> atRest = FindCoincidentPoints(restPoints);
  const std::vector<std::int32_t> moved = FindCoincidentPoints(vectors);
  std::vector<glm::dvec3> pairs(ranks.size());
  for (std::size_t node = 0; node < ranks.size(); ++node)
  {
    pairs[node] = glm::dvec3(atRest[node], moved[node], 0.0);
  }
  const std::vector<std::int32_t> first = FindCoincidentPoints(pairs);
  std::vector<unsigned char> isShared(ranks.size(), 0);
  for (std::size_t node = 0; node < ranks.size(); ++node)
  {
    const auto other = static_cast<std::size_t>(first[node]);
    isShared[other] |= ranks[node] != ranks[other] ? 1 : 0;
  }
  for (Tetrahedron& tetrahedron : tetrahedra)
  {
    for (std::int32_t& node : tetrahedron)
    {
      // Derived nodes lie inside a cell, so no other rank has a copy.
      const auto number = static_cast<std::size_t>(node);
      if (number < ranks.size() && isShared[static_cast<std::size_t>(first[number])] != 0)
      {
        node = first[number];
      }
    }
  }
}

// Returns the text of the first rank that has one; "" if none has. Collective.
std::string GetFirstText(const Ranks& ranks, const std::string& text)
{
  const std::vector<char> texts = ranks.Gather(text.c_str(), text.size() + 1, MESH_NAME);
  const auto first =
    std::find_if(texts.begin(), texts.end(), [](char character) { return character != '\0'; });
  return first == texts.end() ? std::string() : std::string(&*first);
}

} // namespace

struct MeshGathering::Piece
{
  std::vector<Tetrahedron> Tetrahedra;
  DerivedNodes Derived;
  std::vector<glm::dvec3> RestPoints;
  /// Deformed positions if there is a mesh at rest, else displacements.
  std::vector<glm::dvec3> Vectors;
  std::string IgnoredCells;
  std::string WrongOrder;
};

MeshGathering::Piece MeshGathering::Read(
  const DeformationSource& source, const std::vector<std::int32_t>* places) const
{
  const MeshParts& shape = source.ShapeParts;
  const MeshParts& rest = source.Rest ? source.RestParts : shape;
  const std::size_t nodes = GetNumberOfNodes(shape);
  Piece piece;
  if (nodes != GetNumberOfNodes(rest))
  {
    throw Error("A rank has " + std::to_string(nodes) + " points of the deformation mesh and " +
      std::to_string(GetNumberOfNodes(rest)) +
      " of the mesh at rest. Use one mesh, at rest and deformed, divided into the same "
      "pieces.");
  }
  if (nodes == 0)
  {
    return piece;
  }
  MeshCells cells = ReadCells(rest, rest, nullptr, places, &shape);
  if (source.Rest && ReadCells(shape, rest, nullptr, places, &rest).Tetrahedra != cells.Tetrahedra)
  {
    throw Error("The cells of the deformation mesh are not those of the mesh at rest. "
                "Use one mesh, at rest and deformed, divided into the same pieces.");
  }
  piece.Tetrahedra = std::move(cells.Tetrahedra);
  piece.Derived = std::move(cells.Derived);
  piece.IgnoredCells = std::move(cells.Ignored);
  piece.WrongOrder = std::move(cells.WrongOrder);
  piece.RestPoints = ReadPoints(rest, source.Rest ? REST_NAME : MESH_NAME, piece.Tetrahedra);
  if (source.Rest)
  {
    piece.Vectors = ReadPoints(shape, MESH_NAME, piece.Tetrahedra);
    return piece;
  }
  piece.Vectors.resize(nodes);
  NodeFaults faults;
  faults.Resize(nodes);
  ReadPointVectors(shape, source.Selector, faults,
    [&](vtkIdType first, const glm::dvec3* vectors, vtkIdType count)
    { std::copy(vectors, vectors + count, piece.Vectors.begin() + first); });
  CheckPointVectors(shape, source.Selector, source.Wanted, MESH_NAME, faults, piece.Tetrahedra);
  return piece;
}

void MeshGathering::Make(const Piece& whole, bool withRest)
{
  vtkNew<vtkCellArray> cells;
  vtkNew<vtkIdTypeArray> connectivity;
  vtkNew<vtkIdTypeArray> offsets;
  const auto count = static_cast<vtkIdType>(whole.Tetrahedra.size());
  connectivity->SetNumberOfValues(4 * count);
  offsets->SetNumberOfValues(count + 1);
  for (vtkIdType cell = 0; cell < count; ++cell)
  {
    offsets->SetValue(cell, 4 * cell);
    for (int node = 0; node < 4; ++node)
    {
      connectivity->SetValue(4 * cell + node, whole.Tetrahedra[cell][node]);
    }
  }
  offsets->SetValue(count, 4 * count);
  cells->SetData(offsets, connectivity);
  const auto makeGrid = [&](const std::vector<glm::dvec3>& positions)
  {
    const auto grid = vtkSmartPointer<vtkUnstructuredGrid>::New();
    vtkNew<vtkPoints> points;
    points->SetData(MakeArray(positions));
    grid->SetPoints(points);
    grid->SetCells(VTK_TETRA, cells);
    return grid;
  };
  if (withRest)
  {
    this->Shape = makeGrid(whole.Vectors);
    this->Rest = makeGrid(whole.RestPoints);
    return;
  }
  this->Shape = makeGrid(whole.RestPoints);
  this->Rest = nullptr;
  const auto vectors = MakeArray(whole.Vectors);
  vectors->SetName("displacements");
  this->Shape->GetPointData()->AddArray(vectors);
}

DeformationSource MeshGathering::Gather(
  const Ranks& ranks, const DeformationSource& source, bool joins)
{
  if (!ranks.AreMany() || ranks.IsAny(vtkImageData::SafeDownCast(source.Shape) != nullptr))
  {
    return source;
  }
  const Stamp stamp = GetPieceStamp(source);
  if (ranks.IsAny(
        stamp != this->PieceStamp || source.Choice != this->Choice || joins != this->Joined))
  {
    this->PieceStamp.clear();
    const MeshParts& rest = source.Rest ? source.RestParts : source.ShapeParts;
    const bool areSplit = ranks.IsAny(HasOtherCells(rest));
    const std::vector<std::int32_t> places =
      areSplit ? FindPlaces(ranks, rest) : std::vector<std::int32_t>();
    Piece piece;
    ranks.Attempt([&] { piece = this->Read(source, areSplit ? &places : nullptr); });
    std::uint64_t hash = HashOfNothing;
    AddToHash(hash, piece.Tetrahedra);
    AddToHash(hash, piece.Derived.Nodes);
    AddToHash(hash, piece.Derived.Weights);
    AddToHash(hash, piece.RestPoints);
    AddToHash(hash, piece.Vectors);
    this->IgnoredCells = GetFirstText(ranks, piece.IgnoredCells);
    this->WrongOrder = GetFirstText(ranks, piece.WrongOrder);
    if (!ranks.AreEqual(hash))
    {
      const std::size_t mine = piece.RestPoints.size();
      const auto [first, sum] = Count(ranks, mine);
      const auto [firstDerived, sumOfDerived] = Count(ranks, piece.Derived.GetCount());
      const std::uint64_t firstWeight = Count(ranks, piece.Derived.Weights.size())[0];
      if (sum + sumOfDerived > static_cast<std::uint64_t>(std::numeric_limits<std::int32_t>::max()))
      {
        throw Error("The " + std::string(MESH_NAME) +
          " has more than 2,147,483,647 points on all ranks. Use a coarser mesh.");
      }
      for (Tetrahedron& tetrahedron : piece.Tetrahedra)
      {
        for (std::int32_t& node : tetrahedron)
        {
          const auto number = static_cast<std::size_t>(node);
          node = static_cast<std::int32_t>(
            number < mine ? first + number : sum + firstDerived + (number - mine));
        }
      }
      for (std::int32_t& node : piece.Derived.Nodes)
      {
        node += static_cast<std::int32_t>(first);
      }
      for (std::uint64_t& end : piece.Derived.Ends)
      {
        end += firstWeight;
      }
      GatherVector(ranks, piece.Derived.Ends, MESH_NAME);
      GatherVector(ranks, piece.Derived.Nodes, MESH_NAME);
      GatherVector(ranks, piece.Derived.Weights, MESH_NAME);
      GatherVector(ranks, piece.Tetrahedra, MESH_NAME);
      GatherVector(ranks, piece.RestPoints, MESH_NAME);
      GatherVector(ranks, piece.Vectors, MESH_NAME);
      if (joins)
      {
        const std::vector<std::uint64_t> counts = ranks.Gather(mine);
        ranks.Attempt(
          [&]
          {
            std::vector<int> ranksOfNodes;
            for (std::size_t rank = 0; rank < counts.size(); ++rank)
            {
              ranksOfNodes.insert(
                ranksOfNodes.end(), static_cast<std::size_t>(counts[rank]), static_cast<int>(rank));
            }
            JoinCopies(piece.Tetrahedra, piece.RestPoints, piece.Vectors, ranksOfNodes);
          });
      }
    }
    ranks.Attempt([&] { this->Make(piece, source.Rest != nullptr); });
    this->Derived = std::move(piece.Derived);
    this->PieceStamp = stamp;
    this->Choice = source.Choice;
    this->Joined = joins;
  }
  DeformationSource whole = source;
  whole.Shape = this->Shape;
  whole.Rest = this->Rest;
  whole.Derived = &this->Derived;
  whole.ShapeParts = { this->Shape };
  whole.RestParts = this->Rest ? MeshParts{ this->Rest } : MeshParts();
  whole.Selector = [](vtkDataSet* dataSet)
  { return vtkDataSet::SafeDownCast(dataSet)->GetPointData()->GetArray(0); };
  return whole;
}

void AddCellWarnings(
  const RestMesh& mesh, const MeshGathering& gathering, std::set<std::string>& warnings)
{
  const std::string& ignored = mesh.GetIgnoredCells();
  const std::string& cells = ignored.empty() ? gathering.GetIgnoredCells() : ignored;
  const std::string& wrong = mesh.GetWrongOrder();
  const std::string& order = wrong.empty() ? gathering.GetWrongOrder() : wrong;
  for (const std::string& warning : GetCellWarnings(cells, order))
  {
    warnings.insert(warning);
  }
}

} // namespace deformvolume
