// SPDX-License-Identifier: BSD-3-Clause
// What users may rely on for speed and memory, as a test: medians of ratios within rounds on one
// device, so that a slow or busy machine does not matter; the one absolute limit is generous.
// report.py states what is aimed at, and measures it with more rounds.
#include "BenchmarkCase.h"
#include "Peers.h"

#include <vtkImageData.h>

#include <algorithm>
#include <functional>
#include <iostream>
#include <iterator>
#include <utility>
#include <vector>

namespace
{
// All limits, the highest values that are allowed. The volume has 189 x 305 x 229 voxels of 16 bits
// and the mesh 2,197 nodes where nothing else is said.
struct Limit
{
  const char* What;
  double Highest;
};
// The times of whole updates by those of vtkImageReslice with an affine transform, same output.
constexpr Limit UpdateNear{ "near identity: update by affine vtkImageReslice", 1.5 };
constexpr Limit UpdateGeneral{ "general pose: update by affine vtkImageReslice", 1.5 };
// The times of mapping and resampling by those of the published kernel.
constexpr Limit PublishedNear{ "near identity: default by published kernel", 0.15 };
constexpr Limit PublishedGeneral{ "general pose: default by published kernel", 0.2 };
// The times of mapping and resampling by those of the coarse mesh near identity.
constexpr Limit FineMesh{ "near identity: 512000 nodes by 2197 nodes", 1.6 };
constexpr Limit Rotated{ "turned by 45 degrees round each axis, by near identity", 2.5 };
constexpr Limit Scaled{ "scaled by 1.5, by near identity", 2.5 };
constexpr Limit FoldedOver{ "a third folded back over the rest, by near identity", 3.5 };
// Cells ten output voxels long, and as many voxels of the output.
constexpr Limit ThickSlices{ "slices of ten voxels, near identity: by slices of one", 2.0 };
// The times of edits in a box that touches 5 % of the blocks by those of a whole pass.
constexpr Limit EditedInside{ "512000 nodes: edit in the middle by all", 0.15 };
// The times of mapping and resampling with other numbers of nodes and cells.
constexpr Limit NodesAlongZ{ "512000 nodes: numbered along z by along x", 1.1 };
constexpr Limit NodesAtRandom{ "512000 nodes: numbered at random by along x", 1.1 };
// The times of whole updates by those of a grid that stays and has other displacements. Read anew,
// grids took 1.5 to 2.3. What is aimed at, in milliseconds, is in report.py; ParaView's VTK, whose
// own loops run on one thread, needs more.
constexpr Limit SharedArrays{ "512000 nodes: another grid with the same arrays by the same grid",
  1.15 };
constexpr Limit EqualCopies{ "512000 nodes: another grid with equal arrays by the same grid",
  1.25 };
constexpr Limit TwoMeshes{ "512000 nodes: deformed and rest mesh, the former modified, by one grid",
  1.25 };
// Whole updates by their kernels.
constexpr Limit Dense{ "a displacement at each voxel: update by mapping and resampling", 1.35 };
constexpr Limit EditedAtSide{ "512000 nodes: edit on a side by all", 0.25 };
// Whole updates.
constexpr Limit Sampled{ "near identity: update with SamplingFactor 2 by 1", 0.2 };
constexpr Limit BytesCoarse{ "2197 nodes: bytes of device memory per voxel", 6.0 };
constexpr Limit BytesFine{ "512000 nodes: bytes of device memory per voxel", 20.0 };
constexpr Limit Builds{ "static mappings built for moved meshes", 0.0 };
constexpr Limit Uploads{ "uploads of the volume for moved meshes", 0.0 };
constexpr Limit Preprocessing{ "301 x 370 x 316 voxels, 512000 nodes: seconds of preprocessing",
  10.0 };

// So many rounds show a limit that is met. Where one does not seem to be, more of them tell whether
// that was the machine, whose other work may take half of the time of a few rounds.
constexpr int FirstRounds = 5;
constexpr int MostRounds = 15;

int Failures = 0;

void Check(const Limit& limit, double value)
{
  const bool met = value <= limit.Highest;
  std::cout << (met ? "met:     " : "NOT MET: ") << limit.What << ": " << value << ", at most "
            << limit.Highest << "\n";
  Failures += !met;
}

class Ratios
{
public:
  void Add(double value) { this->Values.push_back(value); }

  double GetMedian()
  {
    const auto middle = this->Values.begin() + this->Values.size() / 2;
    std::nth_element(this->Values.begin(), middle, this->Values.end());
    return *middle;
  }

private:
  std::vector<double> Values;
};

double GetBytesPerVoxel(BenchmarkCase& subject)
{
  return static_cast<double>(subject.GetFilter()->GetDeviceMemory()) /
    static_cast<double>(subject.GetNumberOfVoxels());
}

void CheckSpeedAndMemory()
{
  const auto volume = MakeVolume(BenchmarkVolume);
  BenchmarkCase near(volume, CoarseNodes);
  BenchmarkCase sampled(volume, CoarseNodes);
  sampled.GetFilter()->SetSamplingFactor(2);
  BenchmarkCase general(volume, CoarseNodes);
  BenchmarkCase fine(volume, FineNodes);
  BenchmarkCase rotated(volume, CoarseNodes);
  BenchmarkCase scaled(volume, CoarseNodes);
  BenchmarkCase folded(volume, CoarseNodes);
  BenchmarkCase editedInside(volume, FineNodes);
  BenchmarkCase editedAtSide(volume, FineNodes);
  const int exact = vtkDeformVolumeFilter::EXACT;
  BenchmarkCase alongZ(volume, FineNodes, exact, Numbering::AlongZ);
  BenchmarkCase atRandom(volume, FineNodes, exact, Numbering::Random);
  BenchmarkCase shared(volume, FineNodes);
  BenchmarkCase copied(volume, FineNodes);
  BenchmarkCase two(volume, FineNodes);
  two.ConnectRest();
  BenchmarkCase dense(volume, DenseField);
  BenchmarkCase published(volume, CoarseNodes, vtkDeformVolumeFilter::PUBLISHED);
  const auto slices =
    MakeVolume({ BenchmarkVolume[0], BenchmarkVolume[1], BenchmarkVolume[2] / 10 });
  slices->SetSpacing(1.0, 1.0, 10.0);
  BenchmarkCase thick(slices, CoarseNodes);
  thick.GetFilter()->SetOutputSpacingModeToCustomSpacing();
  thick.GetFilter()->SetCustomSpacing(1.0, 1.0, 1.0);
  const auto reslice = MakeAffineReslice(volume);

  const auto update = [](BenchmarkCase& subject, Pose pose, Grid grid = Grid::Same)
  {
    subject.Move(pose, grid);
    return subject.Update();
  };
  // The shortest of some updates in a row. The first one of a short update finds the caches full of
  // what others left there, which is not so while a volume is worked with, and one turn of another
  // process on a processor takes half as long as such an update.
  const auto updateAgain = [&](BenchmarkCase& subject, Pose pose)
  {
    double shortest = update(subject, pose).Update;
    for (int i = 0; i < 3; ++i)
    {
      shortest = std::min(shortest, update(subject, pose).Update);
    }
    return shortest;
  };
  const auto resliceLike = [&](BenchmarkCase& subject)
  {
    return reslice->Update(
      Pose::General, subject.GetStep(), subject.GetFilter()->GetOutput()->GetExtent());
  };

  Ratios updateNear, updateGeneral, publishedNear, publishedGeneral, fineMesh, rotation, scaling,
    folding, slicing, editingInside, editingAtSide, numberingAlongZ, numberingAtRandom, sharing,
    copying, withTwo, denseField, sampling;
  const std::pair<const Limit&, Ratios&> measured[] = { { UpdateNear, updateNear },
    { UpdateGeneral, updateGeneral }, { PublishedNear, publishedNear },
    { PublishedGeneral, publishedGeneral }, { FineMesh, fineMesh },
    { NodesAlongZ, numberingAlongZ }, { NodesAtRandom, numberingAtRandom },
    { SharedArrays, sharing }, { EqualCopies, copying }, { TwoMeshes, withTwo },
    { Dense, denseField }, { Sampled, sampling }, { EditedInside, editingInside },
    { EditedAtSide, editingAtSide }, { Rotated, rotation }, { Scaled, scaling },
    { FoldedOver, folding }, { ThickSlices, slicing } };
  const auto allMet = [&]()
  {
    return std::all_of(std::begin(measured), std::end(measured),
      [](const auto& one) { return one.second.GetMedian() <= one.first.Highest; });
  };
  vtkIdType builds = 0;
  vtkIdType uploads = 0;
  const auto countWork = [&]()
  {
    builds = 0;
    uploads = 0;
    for (BenchmarkCase* subject : { &near, &sampled, &general, &fine, &rotated, &scaled, &folded,
           &editedInside, &editedAtSide, &alongZ, &atRandom, &shared, &copied, &two, &dense })
    {
      builds += subject->GetFilter()->GetNumberOfMappingBuilds();
      uploads += subject->GetFilter()->GetNumberOfVolumeUploads();
    }
  };
  // The first round builds kernels and static mappings, and does not count.
  int rounds = FirstRounds;
  for (int round = 0; round <= rounds; ++round)
  {
    const UpdateTimes nearTimes = update(near, Pose::NearIdentity);
    const double resliceNear = resliceLike(near);
    const double sampledTime = updateAgain(sampled, Pose::NearIdentity);
    const double unsampledTime = updateAgain(near, Pose::NearIdentity);
    const double publishedNearTime = update(published, Pose::NearIdentity).GetKernels();
    const UpdateTimes fineTimes = update(fine, Pose::NearIdentity);
    const double fineTime = fineTimes.GetKernels();
    const double alongZTime = update(alongZ, Pose::NearIdentity).GetKernels();
    const double atRandomTime = update(atRandom, Pose::NearIdentity).GetKernels();
    const double sharedTime = update(shared, Pose::NearIdentity, Grid::SharingArrays).Update;
    const double copiedTime = update(copied, Pose::NearIdentity, Grid::EqualCopy).Update;
    const double twoTime = update(two, Pose::NearIdentity).Update;
    const UpdateTimes denseTimes = update(dense, Pose::NearIdentity);
    const double insideTime = update(editedInside, Pose::LocalEdit).GetKernels();
    const double sideTime = update(editedAtSide, Pose::LocalEditAtSide).GetKernels();
    const double rotatedTime = update(rotated, Pose::Rotated).GetKernels();
    const double scaledTime = update(scaled, Pose::UniformScale).GetKernels();
    const double foldedTime = update(folded, Pose::Folded).GetKernels();
    const double thickTime = update(thick, Pose::NearIdentity).GetKernels();
    const UpdateTimes generalTimes = update(general, Pose::General);
    const double resliceGeneral = resliceLike(general);
    const double publishedGeneralTime = update(published, Pose::General).GetKernels();
    if (round == 0)
    {
      countWork();
      continue;
    }
    updateNear.Add(nearTimes.Update / resliceNear);
    updateGeneral.Add(generalTimes.Update / resliceGeneral);
    publishedNear.Add(nearTimes.GetKernels() / publishedNearTime);
    publishedGeneral.Add(generalTimes.GetKernels() / publishedGeneralTime);
    fineMesh.Add(fineTime / nearTimes.GetKernels());
    numberingAlongZ.Add(alongZTime / fineTime);
    numberingAtRandom.Add(atRandomTime / fineTime);
    sharing.Add(sharedTime / fineTimes.Update);
    copying.Add(copiedTime / fineTimes.Update);
    withTwo.Add(twoTime / fineTimes.Update);
    denseField.Add(denseTimes.Update / denseTimes.GetKernels());
    sampling.Add(sampledTime / unsampledTime);
    editingInside.Add(insideTime / fineTime);
    editingAtSide.Add(sideTime / fineTime);
    rotation.Add(rotatedTime / nearTimes.GetKernels());
    scaling.Add(scaledTime / nearTimes.GetKernels());
    folding.Add(foldedTime / nearTimes.GetKernels());
    slicing.Add(thickTime / nearTimes.GetKernels());
    if (round == FirstRounds && !allMet())
    {
      rounds = MostRounds;
    }
  }
  for (const auto& [limit, ratios] : measured)
  {
    Check(limit, ratios.GetMedian());
  }
  Check(BytesCoarse, GetBytesPerVoxel(near));
  Check(BytesFine, GetBytesPerVoxel(fine));
  const vtkIdType buildsBefore = builds;
  const vtkIdType uploadsBefore = uploads;
  countWork();
  Check(Builds, static_cast<double>(builds - buildsBefore));
  Check(Uploads, static_cast<double>(uploads - uploadsBefore));
}

void CheckPreprocessing()
{
  BenchmarkCase subject(MakeVolume(HeadVolume), FineNodes);
  subject.Move(Pose::NearIdentity);
  Check(Preprocessing, subject.Update().Preprocessing);
}
}

int main()
{
  try
  {
    CheckSpeedAndMemory();
    CheckPreprocessing();
  }
  catch (const std::exception& error)
  {
    std::cerr << error.what() << "\n";
    return EXIT_FAILURE;
  }
  return Failures == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}
