// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeOptions_h
#define DeformVolumeOptions_h

#include "ChainMail.h"
#include "ElasticModel.h"
#include "Push.h"
#include "Tools.h"
#include "TransformReading.h"

#include <array>
#include <optional>
#include <string>
#include <vector>

class vtkDataArray;

/// An argument of the command line that names a file, and the option that it belongs to.
struct NamedFile
{
  std::string Option;
  std::string Path;
};

/// The options of the command line. Lengths are in the world units of the volume.
struct Options
{
  bool ListDevices = false;

  std::string Volume;
  bool FileCoordinates = false;
  std::optional<int> Frame;
  std::string VolumeSpace;
  std::string LabelVolume;
  std::vector<std::string> Points;

  std::string Mesh;
  std::string Displacement;
  std::string Rest;
  std::string MeshSpace;
  double Scale = 1.0;
  std::string Field;
  std::vector<TransformFile> Transforms;
  bool PointsAreDeformed = false;
  bool OpenSplits = false;
  bool FieldIsInverse = false;
  std::string FieldSpace;

  bool TetGen = false;
  std::optional<double> Isovalue;
  std::string Pieces = "all";
  double EdgeLength = 0.0;
  double RadiusEdgeRatio = 1.414;
  std::string TetGenExecutable;
  std::array<int, 3> Lattice{ { 0, 0, 0 } };
  std::vector<Push> Pushes;
  std::string Model;
  std::vector<Pull> Pulls;
  std::vector<Fixation> Fixations;
  std::array<double, 3> Gravity{ { 0.0, 0.0, 0.0 } };
  double YoungModulus = 1e4;
  double PoissonRatio = 0.3;
  double Density = 1000.0;
  double Duration = 1.0;
  /// Tissue from which YoungModulus, PoissonRatio and Density are taken; "" if there is none.
  std::string Tissue;
  std::vector<MaterialOfValues> Materials;

  std::vector<std::string> Cuts;
  std::vector<Carving> Carvings;
  bool SmoothCut = false;

  std::string Reference;
  std::string Outside = "discard";
  std::optional<double> KeepDistance;
  std::string Bounds = "deformed";
  std::optional<std::array<double, 3>> Spacing;
  int Padding = 0;
  std::optional<double> Background;
  std::vector<std::string> CategoricalArrays;
  std::vector<std::string> DensityArrays;
  bool Labels = false;
  std::string Resampler = "automatic";
  std::string Interpolation = "linear";
  std::string Device;

  std::vector<std::string> Outputs;
  std::vector<std::string> LabelOutputs;
  std::vector<std::string> Jacobians;
  std::vector<std::string> FoldCounts;
  std::vector<std::string> InverseFields;
  /// One for each file of Points.
  std::vector<std::string> PointsOutputs;
  std::string MeshOutput;
  std::string Image;
  int Frames = 0;
  std::string Movie;
  std::optional<double> Threshold;
  std::optional<std::array<double, 3>> View;
  bool Quiet = false;

  std::vector<NamedFile> GetOutputs() const;
  /// Whether the volume is deformed. Otherwise only --write-mesh writes a file.
  bool WritesResult() const;
  /// Whether an array holds labels, by --labels or --categorical.
  bool AreLabels(vtkDataArray* array) const;
  bool HasTools() const { return !this->Cuts.empty() || !this->Carvings.empty(); }
  /// Whether --cut cuts the mesh of a model instead of the volume.
  bool CutsMesh() const { return !this->Cuts.empty() && this->HasElasticModel(); }
  /// Whether --fix or --material uses labels.
  bool UsesLabels() const;
  bool HasLattice() const { return this->Lattice[0] > 0; }
  /// Whether the model adds nodes in the middle of edges.
  bool HasMidSideNodes() const { return this->Model == "fem"; }
  /// Whether a model moves the nodes of a mesh.
  bool HasElasticModel() const { return this->Model == "fem" || this->Model == "mass-spring"; }
};

/// Parses the command line. Returns an exit code if the program must exit: 0 after --help, 2 after
/// an error message about the command line.
std::optional<int> ParseCommandLine(int argc, char* argv[], Options& options);

#endif
