// SPDX-License-Identifier: BSD-3-Clause
#include "DeformationChoice.h"

#include "Error.h"
#include "VectorArray.h"

#include "vtkAlgorithm.h"
#include "vtkDataObject.h"
#include "vtkDataSet.h"
#include "vtkDataSetAttributes.h"
#include "vtkDeformVolumeFilter.h"
#include "vtkInformation.h"

#include <cmath>
#include <string>

namespace deformvolume
{

namespace
{

// Sets Selector, Wanted and Choice of a source.
void ChooseVectors(DeformationSource& source, vtkInformation* choice, const ArrayFinder& find)
{
  const int association = choice->Get(vtkDataObject::FIELD_ASSOCIATION());
  if (association != vtkDataObject::FIELD_ASSOCIATION_POINTS &&
    association != vtkDataObject::FIELD_ASSOCIATION_POINTS_THEN_CELLS)
  {
    throw Error("The displacements are not chosen among the arrays of points. Choose an array with "
                "SetInputArrayToProcess() and FIELD_ASSOCIATION_POINTS.");
  }
  const char* name = choice->Get(vtkDataObject::FIELD_NAME());
  const bool unnamed = name && !*name;
  source.Selector = [find, unnamed](vtkDataSet* dataSet)
  {
    int found = vtkDataObject::FIELD_ASSOCIATION_POINTS;
    vtkDataArray* array = unnamed ? FindVectors(dataSet) : find(dataSet, found);
    return found == vtkDataObject::FIELD_ASSOCIATION_POINTS ? array : nullptr;
  };
  if (name && *name)
  {
    source.Wanted = std::string("point array \"") + name + "\"";
  }
  else
  {
    const char* attribute = unnamed ? "Vectors"
                                    : vtkDataSetAttributes::GetAttributeTypeAsString(
                                        choice->Get(vtkDataObject::FIELD_ATTRIBUTE_TYPE()));
    source.Wanted = std::string("active ") + (attribute ? attribute : "Vectors") + " of its points";
  }
  source.Choice =
    source.Wanted + " " + std::to_string(choice->Get(vtkDataObject::FIELD_ASSOCIATION()));
}

} // namespace

DeformationSource ChooseDeformation(vtkDataObject* shape, vtkDataObject* rest,
  vtkInformation* choice, const ArrayFinder& find, const DeformationSettings& settings)
{
  DeformationSource source;
  source.Shape = shape;
  source.Rest = rest;
  ChooseVectors(source, choice, find);
  source.FieldIsInverse = settings.FieldIsInverse;
  source.Choice += source.FieldIsInverse ? " inverse" : "";
  source.PointsAreDeformed = settings.PointsAreDeformed;
  source.Choice += source.PointsAreDeformed ? " deformed" : "";
  source.DisplacementScale = settings.DisplacementScale;
  CheckDisplacementScale(source.DisplacementScale);
  return source;
}

void CheckDisplacementScale(double scale)
{
  if (!std::isfinite(scale))
  {
    throw Error("DisplacementScale is not finite. Set a finite factor.");
  }
}

OutsideVoxels MakeOutsideVoxels(int outsideMode, double fadeDistance)
{
  if (outsideMode != vtkDeformVolumeFilter::KEEP)
  {
    return outsideMode == vtkDeformVolumeFilter::EXTRAPOLATE;
  }
  return MakeKeptVoxels(fadeDistance);
}

void FillDeformationPort(vtkInformation* info)
{
  info->Set(vtkAlgorithm::INPUT_IS_OPTIONAL(), 1);
  // vtkCompositeDataSet has to be first. Otherwise the executive would iterate over the leaves. Its
  // message names the first type only: CheckParts() refuses surfaces.
  info->Set(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkCompositeDataSet");
  info->Append(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkDataSet");
}

void ThrowRestWithoutDeformation(int restPort, int deformationPort)
{
  throw Error("There is a mesh at rest on input port " + std::to_string(restPort) +
    ", but no deformation on input port " + std::to_string(deformationPort) +
    ". Connect the deformation, or disconnect the mesh at rest.");
}

} // namespace deformvolume
