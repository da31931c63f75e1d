// SPDX-License-Identifier: BSD-3-Clause
#include "TransformReading.h"

#include "Failure.h"
#include "FieldReading.h"
#include "Files.h"
#include "ImageAxes.h"
#include "Messages.h"
#include "ProgressBar.h"

#include <itkBSplineTransform.h>
#include <itkCompositeTransform.h>
#include <itkHDF5TransformIOFactory.h>
#include <itkMatlabTransformIOFactory.h>
#include <itkMatrixOffsetTransformBase.h>
#include <itkTransform.h>
#include <itkTransformFactory.h>
#include <itkTransformFileReader.h>
#include <itkTxtTransformIOFactory.h>
#include <itk_H5Cpp.h>

#include <vtkFloatArray.h>
#include <vtkImageInterpolator.h>
#include <vtkMath.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkSMPTools.h>
#include <vtkTrivialProducer.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <memory>

namespace
{
using ItkTransform = itk::Transform<double, 3, 3>;

// A map of points in the world coordinates left, posterior, superior.
class PointMap
{
public:
  virtual ~PointMap() = default;
  virtual void Apply(double point[3]) const = 0;
};

class TransformMap : public PointMap
{
public:
  explicit TransformMap(ItkTransform* transform)
    : Transform(transform)
  {
  }
  void Apply(double point[3]) const override
  {
    const auto moved = this->Transform->TransformPoint(ItkTransform::InputPointType(point));
    std::copy_n(moved.GetDataPointer(), 3, point);
  }

private:
  ItkTransform::ConstPointer Transform;
};

// A displacement field, with the conventions of ITK: linear interpolation up to half a voxel
// outside the grid, and no displacement beyond that.
class FieldMap : public PointMap
{
public:
  explicit FieldMap(vtkImageData* field)
    : Field(field)
  {
    field->GetPointData()->SetScalars(field->GetPointData()->GetVectors());
    constexpr double halfVoxel = 0.5;
    this->Interpolator->SetTolerance(halfVoxel);
    this->Interpolator->SetInterpolationModeToLinear();
    this->Interpolator->Initialize(field);
    this->Interpolator->Update();
  }
  void Apply(double point[3]) const override
  {
    double index[3];
    this->Field->TransformPhysicalPointToContinuousIndex(point, index);
    if (this->Interpolator->CheckBoundsIJK(index))
    {
      double vector[3];
      this->Interpolator->InterpolateIJK(index, vector);
      vtkMath::Add(point, vector, point);
    }
  }

private:
  vtkSmartPointer<vtkImageData> Field;
  vtkNew<vtkImageInterpolator> Interpolator;
};

// Returns how many numbers a text file has; 0 if it has any other text. Stops after 17, which is
// more than a matrix has.
int CountNumbers(const std::string& path)
{
  std::ifstream file(path);
  int count = 0;
  constexpr int most = 17;
  for (double number = 0.0; count < most && file >> number; ++count)
  {
  }
  return file.eof() || count == most ? count : 0;
}

// Throws a Failure for transforms of other programs, with the command that converts them.
void CheckProgram(const std::string& path, const std::string& what)
{
  if (HasSuffix(path, { ".lta", ".dat", ".xfm" }))
  {
    throw Failure(what + ": it is a transform of FreeSurfer. Convert it first: " +
      (HasSuffix(path, { ".lta" })      ? "lta_convert --inlta "
          : HasSuffix(path, { ".dat" }) ? "lta_convert --inreg "
                                        : "lta_convert --inmni ") +
      path + " --outitk transform.txt" +
      (HasSuffix(path, { ".lta" }) ? "" : " --src MOVING.mgz --trg FIXED.mgz"));
  }
  if (HasSuffix(path, { ".m3z", ".mgz" }))
  {
    throw Failure(what +
      ": it is a warp of FreeSurfer. Convert it first: mri_warp_convert --inm3z " + path +
      " --outitk warp.nii.gz");
  }
  constexpr int numbersOfMatrix = 16;
  if (CountNumbers(path) == numbersOfMatrix)
  {
    throw Failure(what +
      ": it is a matrix of 16 numbers, as written by FSL and NiftyReg. Convert it first; of FSL: "
      "c3d_affine_tool -ref FIXED.nii.gz -src MOVING.nii.gz " +
      path + " -fsl2ras -oitk transform.txt; of NiftyReg: c3d_affine_tool " + path +
      " -oitk transform.txt");
  }
  std::ifstream file(path);
  std::string line;
  while (std::getline(file, line) && (line.empty() || line.rfind("//", 0) == 0))
  {
  }
  if (line.rfind('(', 0) == 0)
  {
    throw Failure(what +
      ": it is a parameter file of elastix. Let transformix write the displacement field "
      "(transformix -def all -tp " +
      path + " -out FOLDER) and give deformationField with --transform");
  }
}

// Throws a Failure if transforms of a text file lack their parameters, as in a file that is cut
// off. ITK makes such a transform the identity.
void CheckText(const std::string& path, const std::string& what)
{
  std::ifstream file(path);
  std::map<std::string, int> lines;
  for (std::string line; std::getline(file, line);)
  {
    const bool isComposite = line.find(" CompositeTransform") != std::string::npos;
    lines[line.substr(0, line.find(':'))] += isComposite ? 0 : 1;
  }
  for (const char* key : { "Parameters", "FixedParameters" })
  {
    if (lines[key] < lines["Transform"])
    {
      throw Failure(
        what + ": it is damaged or cut off. A line \"" + key + ":\" of a transform is missing");
    }
  }
}

// Makes the center of a transform effective. ITK's VersorTransform ignores that of its file.
void ApplyCenter(ItkTransform* transform)
{
  if (auto* const composite = dynamic_cast<itk::CompositeTransform<double, 3>*>(transform))
  {
    for (itk::SizeValueType i = 0; i < composite->GetNumberOfTransforms(); ++i)
    {
      ApplyCenter(composite->GetNthTransformModifiablePointer(i));
    }
  }
  else if (auto* const matrix =
             dynamic_cast<itk::MatrixOffsetTransformBase<double, 3, 3>*>(transform))
  {
    const auto center = matrix->GetCenter();
    matrix->SetCenter(center);
  }
}

// Returns why ITK could not read a file. Its own message is about ITK's source code.
std::string Explain(const std::exception& error)
{
  const std::string text = error.what();
  const std::string before = "Could not create an instance of \"";
  const std::size_t found = text.find(before);
  if (found == std::string::npos)
  {
    return "it is damaged, or holds no transform that ITK can read";
  }
  const std::size_t begin = found + before.size();
  return "it holds " + text.substr(begin, text.find('"', begin) - begin) +
    ", a type of transform that ITK cannot read. Let the registration program write an affine "
    "transform, a B-spline transform or a displacement field";
}

ItkTransform::Pointer ReadTransform(const TransformFile& file, const std::string& what)
{
  if (!HasSuffix(file.Path, { ".h5", ".hdf5", ".tfm", ".txt", ".mat" }))
  {
    throw Failure(what +
      ": a transform is a .h5, .tfm, .txt or .mat file of ITK, ANTs or 3D Slicer, or a "
      "displacement field (.nii, .nii.gz, .mha, .mhd, .nrrd or .nhdr)");
  }
  static const bool areFormatsKnown = []
  {
    itk::HDF5TransformIOFactory::RegisterOneFactory();
    itk::MatlabTransformIOFactory::RegisterOneFactory();
    itk::TxtTransformIOFactory::RegisterOneFactory();
    itk::TransformFactory<itk::MatrixOffsetTransformBase<double, 3, 3>>::RegisterTransform();
    // Of B-splines ITK itself knows order 3 only.
    itk::TransformFactory<itk::BSplineTransform<double, 3, 1>>::RegisterTransform();
    itk::TransformFactory<itk::BSplineTransform<double, 3, 2>>::RegisterTransform();
    H5::Exception::dontPrint();
    return true;
  }();
  static_cast<void>(areFormatsKnown);
  if (HasSuffix(file.Path, { ".tfm", ".txt" }))
  {
    CheckText(file.Path, what);
  }
  const auto reader = itk::TransformFileReader::New();
  reader->SetFileName(file.Path);
  const auto* const list = reader->GetTransformList();
  try
  {
    reader->Update();
  }
  catch (const std::exception& error)
  {
    throw Failure(what + ": " + Explain(error));
  }
  if (list->size() != 1)
  {
    throw Failure(what + ": it holds " + std::to_string(list->size()) +
      " transforms, but not their order. Write them as one composite transform, or in separate "
      "files");
  }
  auto* const transform = dynamic_cast<ItkTransform*>(list->front().GetPointer());
  if (!transform)
  {
    throw Failure(what + ": it holds " + list->front()->GetTransformTypeAsString() +
      ", but a transform of points in three dimensions is needed");
  }
  ApplyCenter(transform);
  if (!file.IsInverted)
  {
    return transform;
  }
  const auto inverse = transform->GetInverseTransform();
  auto* const points = dynamic_cast<ItkTransform*>(inverse.GetPointer());
  if (!points)
  {
    throw Failure(what + ": a " + transform->GetNameOfClass() +
      " cannot be inverted. Only matrices can be inverted, and transforms that were written with "
      "their inverse. Let the registration program write the transform of the opposite direction");
  }
  return points;
}

std::unique_ptr<PointMap> ReadMap(
  const TransformFile& file, const Volume& world, Messages& messages, bool showProgress)
{
  const std::string what = "cannot use the transform " + file.Path;
  const std::string fault = FindReadingFault(file.Path);
  if (!fault.empty())
  {
    throw Failure(what + ": " + fault);
  }
  if (IsFieldFile(file.Path) && !IsVTKFile(file.Path))
  {
    if (file.IsInverted)
    {
      throw Failure(what +
        ": a displacement field cannot be inverted. Use the inverse field, which registration "
        "programs also write (ANTs: the file InverseWarp)");
    }
    FieldOptions options;
    options.IsInverse = true;
    return std::make_unique<FieldMap>(ReadField(file.Path, world, options, messages, showProgress));
  }
  CheckProgram(file.Path, what);
  return std::make_unique<TransformMap>(ReadTransform(file, what));
}
}

vtkSmartPointer<vtkImageData> ReadTransforms(const std::vector<TransformFile>& files,
  const Volume& volume, vtkImageData* grid, Messages& messages, bool showProgress)
{
  if (volume.Axes == WorldAxes::Unknown)
  {
    throw Failure("--transform needs the world coordinates left, posterior, superior, but the file "
                  "of the volume does not state its world coordinates. Give --volume-space");
  }
  Volume world;
  world.Axes = WorldAxes::LeftPosteriorSuperior;
  std::vector<std::unique_ptr<PointMap>> maps;
  for (const TransformFile& file : files)
  {
    maps.push_back(ReadMap(file, world, messages, showProgress));
  }
  std::reverse(maps.begin(), maps.end());

  auto field = vtkSmartPointer<vtkImageData>::New();
  field->CopyStructure(grid);
  vtkNew<vtkFloatArray> vectors;
  vectors->SetName(FieldArrayName);
  vectors->SetNumberOfComponents(3);
  vectors->SetNumberOfTuples(field->GetNumberOfPoints());
  field->GetPointData()->SetVectors(vectors);

  const double sign = volume.Axes == WorldAxes::RightAnteriorSuperior ? -1.0 : 1.0;
  int extent[6];
  field->GetExtent(extent);
  const int columns = extent[1] - extent[0] + 1;
  const int rows = extent[3] - extent[2] + 1;
  const auto mapRow = [&](int z, int y)
  {
    float* to = vectors->GetPointer(
      3 * static_cast<vtkIdType>(columns) * ((z - extent[4]) * static_cast<vtkIdType>(rows) + y));
    for (int x = 0; x < columns; ++x, to += 3)
    {
      double rest[3];
      field->TransformIndexToPhysicalPoint(extent[0] + x, extent[2] + y, z, rest);
      double point[3] = { sign * rest[0], sign * rest[1], rest[2] };
      for (const auto& map : maps)
      {
        map->Apply(point);
      }
      to[0] = static_cast<float>(sign * point[0] - rest[0]);
      to[1] = static_cast<float>(sign * point[1] - rest[1]);
      to[2] = static_cast<float>(point[2] - rest[2]);
    }
  };
  const vtkNew<vtkTrivialProducer> progress;
  const ProgressBar bar(progress, "transforming", showProgress);
  for (int z = extent[4]; z <= extent[5]; ++z)
  {
    vtkSMPTools::For(0, rows,
      [&](vtkIdType begin, vtkIdType end)
      {
        for (vtkIdType y = begin; y < end; ++y)
        {
          mapRow(z, static_cast<int>(y));
        }
      });
    progress->UpdateProgress((z - extent[4] + 1.0) / (extent[5] - extent[4] + 1.0));
  }
  return field;
}
