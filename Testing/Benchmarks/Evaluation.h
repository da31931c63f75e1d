// SPDX-License-Identifier: BSD-3-Clause
#ifndef Evaluation_h
#define Evaluation_h

#include "BenchmarkCase.h"
#include "Rounds.h"

#include <string>

// The parts of the evaluation. Each function registers its measurements with Google Benchmark.
// report.py finds them by their names.

struct EvaluationSize
{
  /// Few rounds and few sizes, to check that everything works.
  bool Quick = false;

  int GetRounds() const { return this->Quick ? 1 : 7; }
  /// Returns the number of rounds for measurements that take long.
  int GetSlowRounds() const { return this->Quick ? 1 : 5; }
  /// Returns the number of rounds for short measurements whose difference is smaller than the
  /// variation of the machine.
  int GetManyRounds() const { return this->Quick ? 1 : 21; }
  /// Whether peers have a first turn that does not count, as all other contestants have.
  bool GetWarmUp() const { return !this->Quick; }
};

/// Deform/<pose>/<deformation>/<resampler>, Deform/<pose>/<peer>: table 1 and the peers. For the
/// deformation "inverse", the vectors of the dense field are used as those of an inverse field.
void RegisterComparison(const EvaluationSize& size);

/// Nodes/<pose>/<nodes>: meshes of few and of many nodes, in a group of their own.
void RegisterNodes(const EvaluationSize& size);

/// Readback/<pose>/<at-once, unread or later>: an output that is copied in the update, and outputs
/// that stay on the device (OutputOnDevice). On a CPU there is no difference.
void RegisterReadback(const EvaluationSize& size);

/// Published/<pose>/<exact or published>: the published method; times of the kernels are compared.
void RegisterPublished(const EvaluationSize& size);

/// Probe/<pose>/<resampler or probe>: the slowest peer.
void RegisterProbe(const EvaluationSize& size);

/// Poses/<pose>: the volume of the comparison.
void RegisterPoses(const EvaluationSize& size);

/// TightMesh/<nodes>/<boundary or without>: meshes that end within the volume.
void RegisterTightMeshes(const EvaluationSize& size);

/// Tetrahedra/<number>/<resampler>: figure 7.
void RegisterTetrahedra(const EvaluationSize& size);

/// Voxels/<dimensions>/<resampler>: figure 8.
void RegisterVoxels(const EvaluationSize& size);

/// Preprocess/<dimensions>/<nodes>: the static mapping.
void RegisterPreprocessing(const EvaluationSize& size);

/// Given/<form>: one mesh with displacements, in a new grid with the same arrays, or as two meshes,
/// and a displacement for each voxel.
void RegisterGivenMeshes(const EvaluationSize& size);

/// Incremental/<whole or local>: a mesh that moves in one place only.
void RegisterIncremental(const EvaluationSize& size);

/// Live/<edit>: nodes that move or are split, and cells that are switched off, between two frames.
void RegisterLive(const EvaluationSize& size);

/// Edit/<dimensions>/<edit>: cutting and carving.
void RegisterEdits(const EvaluationSize& size);

/// Masks/<active or blanked>/<change>: a mask of the volume that appears or changes.
void RegisterMasks(const EvaluationSize& size);

/// ChainMail/<dimensions>/<part or whole>: frames of a drag, the volume updated in part or whole.
/// ChainMailStep/<voxels>/step: steps alone, which move about <voxels> voxels.
void RegisterChainMail(const EvaluationSize& size);

/// Physics/<body>/frame: frames of springs and of finite elements.
void RegisterPhysics(const EvaluationSize& size);

/// Session/<body>/<drag, cut or carve>: a live session, from an event to the output. Does not exist
/// with ParaView's VTK.
void RegisterSession(const EvaluationSize& size);

/// A resampler, and its name in the results.
struct NamedResampler
{
  const char* Name;
  int Resampler;
};
inline constexpr NamedResampler ExactResampler{ "exact", vtkDeformVolumeFilter::EXACT };
inline constexpr NamedResampler MeshRasterizationResampler{ "mesh-rasterization",
  vtkDeformVolumeFilter::MESH_RASTERIZATION };
inline constexpr NamedResampler AllResamplers[] = { ExactResampler, MeshRasterizationResampler };

/// Updates a case.
Measurement MeasureUpdate(BenchmarkCase& subject);

/// Moves the nodes of a case, and updates it.
Measurement Measure(BenchmarkCase& subject, Pose pose, Grid grid = Grid::Same);

/// 189x305x229
std::string GetName(const std::array<int, 3>& dimensions);

#endif
