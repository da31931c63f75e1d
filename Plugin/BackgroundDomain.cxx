// SPDX-License-Identifier: BSD-3-Clause
#include "BackgroundDomain.h"

#include "vtkClientServerInterpreter.h"
#include "vtkClientServerInterpreterInitializer.h"
#include "vtkDataArray.h"
#include "vtkDataObject.h"
#include "vtkDataSetAttributes.h"
#include "vtkObjectFactory.h"
#include "vtkPVArrayInformation.h"
#include "vtkPVDataInformation.h"
#include "vtkPVDataSetAttributesInformation.h"
#include "vtkSMDoubleRangeDomain.h"
#include "vtkSMPropertyHelper.h"

namespace deformvolume
{

namespace
{

// ParaView creates an object of this class for the XML element BackgroundDomain.
class vtkSMBackgroundDomain : public vtkSMDoubleRangeDomain
{
public:
  static vtkSMBackgroundDomain* New();
  vtkTypeMacro(vtkSMBackgroundDomain, vtkSMDoubleRangeDomain);

  // ParaView calls this for new proxies, not for proxies that are loaded from state files.
  int SetDefaultValues(vtkSMProperty* property, bool useUnchecked) override
  {
    vtkSMPropertyHelper helper(property);
    helper.SetUseUnchecked(useUnchecked);
    helper.Set(this->FindBackground());
    return 1;
  }

private:
  double FindBackground()
  {
    vtkPVDataInformation* data = this->GetInputDataInformation("Input");
    vtkPVDataSetAttributesInformation* arrays =
      data ? data->GetAttributeInformation(vtkDataObject::POINT) : nullptr;
    vtkPVArrayInformation* array =
      arrays ? arrays->GetAttributeInformation(vtkDataSetAttributes::SCALARS) : nullptr;
    if (!array && arrays && arrays->GetNumberOfArrays() > 0)
    {
      array = arrays->GetArrayInformation(0);
    }
    if (!array || array->GetNumberOfComponents() != 1 ||
      vtkDataArray::GetDataTypeMin(array->GetDataType()) >= 0.0)
    {
      return 0.0;
    }
    const double* range = array->GetComponentFiniteRange(0);
    return range && range[0] <= range[1] ? range[0] : 0.0;
  }
};

vtkStandardNewMacro(vtkSMBackgroundDomain);

vtkObjectBase* NewDomain(void*)
{
  return vtkSMBackgroundDomain::New();
}

} // namespace

void RegisterBackgroundDomain()
{
  vtkClientServerInterpreterInitializer::GetInitializer()->RegisterCallback(
    [](vtkClientServerInterpreter* interpreter)
    { interpreter->AddNewInstanceFunction("vtkSMBackgroundDomain", NewDomain); });
}

} // namespace deformvolume
