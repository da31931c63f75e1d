// SPDX-License-Identifier: BSD-3-Clause
// Measures the additional time of the cells that the boundary of the mesh crosses: meshes over a
// body of 100 voxels on each axis are updated with these cells and without.
#include "Evaluation.h"

#include <StaticMapping.h>
#include <VolumeDeformer.h>

#include <vtkLatticeTetrahedraSource.h>
#include <vtkNew.h>
#include <vtkUnstructuredGrid.h>

#include <array>
#include <chrono>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

namespace
{

using namespace deformvolume;

constexpr int Size = 120;
const Extent Volume{ { 0, Size - 1, 0, Size - 1, 0, Size - 1 } };
constexpr double BodyBegin = 9.7;
constexpr double BodyEnd = 109.7;

class TightMesh
{
public:
  TightMesh(int nodesPerAxis, bool withBoundary)
  {
    vtkNew<vtkLatticeTetrahedraSource> source;
    source->SetNumberOfNodes(nodesPerAxis, nodesPerAxis, nodesPerAxis);
    source->SetBounds(BodyBegin, BodyEnd, BodyBegin, BodyEnd, BodyBegin, BodyEnd);
    source->Update();
    vtkUnstructuredGrid* lattice = source->GetOutput();
    for (vtkIdType id = 0; id < lattice->GetNumberOfPoints(); ++id)
    {
      double point[3];
      lattice->GetPoint(id, point);
      this->Points.emplace_back(point[0], point[1], point[2]);
    }
    vtkNew<vtkIdList> ids;
    for (vtkIdType id = 0; id < lattice->GetNumberOfCells(); ++id)
    {
      lattice->GetCellPoints(id, ids);
      Tetrahedron tetrahedron;
      for (std::size_t k = 0; k < 4; ++k)
      {
        tetrahedron[k] = static_cast<std::int32_t>(ids->GetId(static_cast<vtkIdType>(k)));
      }
      this->Tetrahedra.push_back(tetrahedron);
    }
    const auto count = static_cast<std::size_t>(GetNumberOfPoints(Volume));
    std::vector<std::uint16_t> values(count);
    for (std::size_t i = 0; i < count; ++i)
    {
      values[i] = static_cast<std::uint16_t>(i * 7919 % 3001);
    }
    this->Output.resize(count);
    this->Coverage.resize(count);
    VolumeArray array;
    array.Data = values.data();
    array.Type = ElementType::UInt16;
    array.Components = 1;
    this->Deformer.SetDevice("");
    VoxelGrid grid;
    grid.VertexExtent = Volume;
    this->Deformer.SetVoxelGrid(grid);
    this->Deformer.SetArrays({ array });
    const StaticMapping mapping = BuildStaticMapping(
      Volume, glm::dvec3(1.0), this->Points, this->Tetrahedra, false, StaticMappingForm::Automatic);
    const MeshBoundary* boundary = withBoundary ? &mapping.Boundary : nullptr;
    if (mapping.Links.empty())
    {
      this->Deformer.SetMesh(this->Tetrahedra.data(), this->Tetrahedra.size(), this->Points.size(),
        mapping.Runs, boundary);
    }
    else
    {
      this->Deformer.SetMesh(this->Tetrahedra.data(), this->Tetrahedra.size(), this->Points.size(),
        mapping.Links.data(), boundary);
    }
  }

  Measurement Measure()
  {
    // All nodes move before each update.
    this->Phase += 0.1;
    std::vector<float> displacements;
    for (const glm::dvec3& p : this->Points)
    {
      displacements.push_back(static_cast<float>(0.3 + 1.5 * std::sin(p.y / 20.0 + this->Phase)));
      displacements.push_back(static_cast<float>(0.3 + 1.5 * std::cos(p.z / 25.0 + this->Phase)));
      displacements.push_back(static_cast<float>(0.3 + 1.5 * std::sin(p.x / 30.0 + this->Phase)));
    }
    DeformRequest request;
    request.OutputExtent = Volume;
    request.Outputs = { this->Output.data() };
    request.Coverage = this->Coverage.data();
    const auto begin = std::chrono::steady_clock::now();
    this->Deformer.SetNodeDisplacements(displacements.data());
    this->Deformer.Deform(request);
    Measurement measurement;
    measurement.Seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    return measurement;
  }

private:
  std::vector<glm::dvec3> Points;
  std::vector<Tetrahedron> Tetrahedra;
  std::vector<std::uint16_t> Output;
  std::vector<signed char> Coverage;
  VolumeDeformer Deformer;
  double Phase = 0.0;
};

using TightCases = std::map<std::string, std::unique_ptr<TightMesh>>;

}

void RegisterTightMeshes(const EvaluationSize& size)
{
  for (const int nodes : { 5, 13, 37 })
  {
    std::vector<Contestant<TightCases>> contestants;
    for (const char* const name : { "boundary", "without" })
    {
      contestants.push_back(
        { name, [name](TightCases& cases) { return cases.at(name)->Measure(); } });
    }
    RegisterRounds<TightCases>(
      "TightMesh/" + std::to_string(nodes * nodes * nodes), size.GetManyRounds(),
      [nodes]()
      {
        auto cases = std::make_shared<TightCases>();
        (*cases)["boundary"] = std::make_unique<TightMesh>(nodes, true);
        (*cases)["without"] = std::make_unique<TightMesh>(nodes, false);
        return cases;
      },
      contestants);
  }
}
