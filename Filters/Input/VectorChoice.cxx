// SPDX-License-Identifier: BSD-3-Clause
#include "VectorChoice.h"

#include "VectorArray.h"

#include "vtkDataObject.h"
#include "vtkDataSet.h"
#include "vtkDataSetAttributes.h"
#include "vtkInformation.h"

#include <string>

namespace deformvolume
{

void ChooseVectors(DeformationSource& source, vtkInformation* choice, const ArrayFinder& find)
{
  const char* name = choice->Get(vtkDataObject::FIELD_NAME());
  const bool unnamed = name && !*name;
  source.Selector = [find, unnamed](vtkDataSet* dataSet)
  {
    int association = vtkDataObject::FIELD_ASSOCIATION_POINTS;
    vtkDataArray* array = unnamed ? FindVectors(dataSet) : find(dataSet, association);
    return association == vtkDataObject::FIELD_ASSOCIATION_POINTS ? array : nullptr;
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

} // namespace deformvolume
