// SPDX-License-Identifier: BSD-3-Clause
#include "InformationRefresh.h"

#include "vtkCallbackCommand.h"
#include "vtkNew.h"
#include "vtkProcessModule.h"
#include "vtkSMProperty.h"
#include "vtkSMPropertyHelper.h"
#include "vtkSMProxyIterator.h"
#include "vtkSMProxyManager.h"
#include "vtkSMRepresentationProxy.h"
#include "vtkSMSession.h"
#include "vtkSMSessionProxyManager.h"
#include "vtkSMSourceProxy.h"
#include "vtkSessionIterator.h"
#include "vtkSmartPointer.h"

#include <string>

namespace deformvolume
{

namespace
{

// After a failed update, ParaView 5.11 does not mark a representation as modified again. Its view
// would never show the output of the corrected pipeline.
void EndUpdate(vtkObject* view, unsigned long, void*, void*)
{
  auto* proxy = static_cast<vtkSMProxy*>(view);
  for (unsigned int i = 0; i < proxy->GetNumberOfProducers(); ++i)
  {
    if (auto* shown = vtkSMRepresentationProxy::SafeDownCast(proxy->GetProducerProxy(i)))
    {
      shown->PostUpdateData(false);
    }
  }
}

// Without this reset, state files would save the values of removed properties again, although the
// filter ignores these values with a warning (vtkDeformVolumeFilter::SetFromState()).
void ResetRemovedProperties(vtkSMProxy* proxy)
{
  for (const char* name :
    { "StreamInput", "WorkGroupSize", "NumberOfTimeSamples", "Resampler", "PieceMode" })
  {
    vtkSMProperty* property = proxy->GetProperty(name);
    // Of Resampler and PieceMode, only the value 1 was removed.
    const bool isRemoved = std::string(name) != "Resampler" && std::string(name) != "PieceMode";
    if (property && !property->IsValueDefault() &&
      (isRemoved || vtkSMPropertyHelper(proxy, name, true).GetAsInt() == 1))
    {
      property->ResetToXMLDefaults();
    }
  }
  proxy->UpdateVTKObjects();
}

void Fetch(vtkObject* object, unsigned long, void*, void*)
{
  auto* proxy = static_cast<vtkSMProxy*>(object);
  ResetRemovedProperties(proxy);
  proxy->UpdatePropertyInformation();
}

void ObserveProxy(vtkSMProxy* proxy)
{
  static vtkNew<vtkCallbackCommand> end;
  end->SetCallback(EndUpdate);
  if (proxy && proxy->IsA("vtkSMViewProxy") &&
    !proxy->HasObserver(vtkCommand::UpdateDataEvent, end))
  {
    proxy->AddObserver(vtkCommand::UpdateDataEvent, end);
  }
  static vtkNew<vtkCallbackCommand> fetch;
  fetch->SetCallback(Fetch);
  const char* name = proxy && proxy->IsA("vtkSMSourceProxy") ? proxy->GetVTKClassName() : nullptr;
  const std::string className = name ? name : "";
  if (className == "vtkDeformVolumeFilter" || className == "vtkTetGenMesher")
  {
    ResetRemovedProperties(proxy);
  }
  if ((className == "vtkDeformVolumeFilter" || className == "vtkTetGenMesher" ||
        className == "vtkCutVolume" || className == "vtkCarveVolume" ||
        className == "vtkChainMailDeformation" || className == "vtkLatticeTetrahedraSource" ||
        className == "vtkMassSpringDeformation" || className == "vtkFiniteElementDeformation" ||
        className == "vtkMaterialFromVolume") &&
    !proxy->HasObserver(vtkCommand::UpdateDataEvent, fetch))
  {
    proxy->AddObserver(vtkCommand::UpdateDataEvent, fetch);
  }
}

void Registered(vtkObject*, unsigned long, void*, void* data)
{
  const auto* information = static_cast<vtkSMProxyManager::RegisteredProxyInformation*>(data);
  if (information->Type == vtkSMProxyManager::RegisteredProxyInformation::PROXY)
  {
    ObserveProxy(information->Proxy);
  }
}

void ObserveSession(vtkSession* session)
{
  static vtkNew<vtkCallbackCommand> registered;
  registered->SetCallback(Registered);
  const auto client = vtkSMSession::SafeDownCast(session);
  vtkSMSessionProxyManager* proxies = client ? client->GetSessionProxyManager() : nullptr;
  if (!proxies || proxies->HasObserver(vtkCommand::RegisterEvent, registered))
  {
    return;
  }
  proxies->AddObserver(vtkCommand::RegisterEvent, registered);
  vtkNew<vtkSMProxyIterator> present;
  present->SetSessionProxyManager(proxies);
  for (present->Begin(); !present->IsAtEnd(); present->Next())
  {
    ObserveProxy(present->GetProxy());
  }
}

void Connected(vtkObject* module, unsigned long, void*, void* id)
{
  ObserveSession(
    static_cast<vtkProcessModule*>(module)->GetSession(*static_cast<const vtkIdType*>(id)));
}

} // namespace

void ObserveSessions()
{
  static vtkNew<vtkCallbackCommand> connected;
  connected->SetCallback(Connected);
  vtkProcessModule* module = vtkProcessModule::GetProcessModule();
  if (!module || module->HasObserver(vtkCommand::ConnectionCreatedEvent, connected))
  {
    return;
  }
  module->AddObserver(vtkCommand::ConnectionCreatedEvent, connected);
  const auto sessions = vtkSmartPointer<vtkSessionIterator>::Take(module->NewSessionIterator());
  for (sessions->InitTraversal(); !sessions->IsDoneWithTraversal(); sessions->GoToNextItem())
  {
    ObserveSession(sessions->GetCurrentSession());
  }
}

} // namespace deformvolume
