// SPDX-License-Identifier: BSD-3-Clause
#include "vtkDeviceVolumeMapper.h"

#include "CurrentOpenGLContext.h"
#include "DeviceOutput.h"
#include "TextureValues.h"

#include "vtkImageData.h"
#include "vtkObjectFactory.h"
#include "vtkOpenGLRenderWindow.h"
#include "vtkOpenGLState.h"
#include "vtkPixelBufferObject.h"
#include "vtkPointData.h"
#include "vtkRenderer.h"
#include "vtkTextureObject.h"
#include "vtkVolume.h"
#include "vtkVolumeInputHelper.h"
#include "vtkVolumeProperty.h"
#include "vtkVolumeTexture.h"
#include "vtkWeakPointer.h"

#include <cstdint>
#include <limits>
#include <optional>

using namespace deformvolume;

// Rows of a texture follow each other without gaps: GL_UNPACK_ALIGNMENT, which the headers of
// OpenGL define, whose names differ between versions of VTK.
constexpr unsigned int UnpackAlignment = 0x0CF5;

static bool HasPartitions(vtkVolumeTexture* texture)
{
  const auto& partitions = texture->GetPartitions();
  return partitions[0] > 1 || partitions[1] > 1 || partitions[2] > 1;
}

class vtkDeviceVolumeMapper::Internals
{
public:
  /// What has been filled and is drawn, in place of the scalars of the input.
  vtkSmartPointer<vtkDataArray> Loaded;
  /// The window that the superclass has drawn one input in, and has what it needs for: in another
  /// one it loads the texture again.
  vtkWeakPointer<vtkRenderWindow> ReadyFor;
  /// Whether what belongs to a window has been released.
  bool IsReleased = true;

  /// Makes the buffer for values of an array, in the OpenGL context that is current.
  void Reserve(vtkRenderWindow* window, const OpenGLContext& context, vtkDataArray* values)
  {
    if (this->Shared && this->Context == context && this->Pixels->GetContext() == window &&
      this->Pixels->GetType() == values->GetDataType() &&
      this->Pixels->GetComponents() == values->GetNumberOfComponents() &&
      static_cast<vtkIdType>(this->Pixels->GetSize()) == values->GetNumberOfValues())
    {
      return;
    }
    this->Release();
    this->Pixels = vtkSmartPointer<vtkPixelBufferObject>::New();
    this->Pixels->SetContext(window);
    this->Pixels->Allocate(values->GetDataType(),
      static_cast<unsigned int>(values->GetNumberOfTuples()), values->GetNumberOfComponents(),
      vtkPixelBufferObject::UNPACKED_BUFFER);
    this->Context = context;
    this->Shared = std::make_unique<OpenGLBuffer>(this->Pixels->GetHandle(), context);
  }
  /// Arrays that are on the device, and have a name, get others in their place. The mapper keeps
  /// its input, and their filter brings those to the host that somebody holds.
  static void Take(vtkImageData* input)
  {
    vtkPointData* const points = input->GetPointData();
    for (int i = 0; i < points->GetNumberOfArrays(); ++i)
    {
      vtkDataArray* const array = points->GetArray(i);
      const auto* const holder = dynamic_cast<DeviceOutputHolder*>(array);
      if (holder && holder->GetDeviceOutput() && IsNamed(array))
      {
        points->AddArray(MakeTextureValues(array)); // in the place of that of the same name
      }
    }
  }
  /// The input has the arrays again that were taken from it.
  static void GiveBack(vtkImageData* input)
  {
    vtkPointData* const points = input->GetPointData();
    for (int i = 0; i < points->GetNumberOfArrays(); ++i)
    {
      const auto* const values = dynamic_cast<TextureValues*>(points->GetArray(i));
      if (values && values->GetValues())
      {
        points->AddArray(values->GetValues());
      }
    }
  }
  static bool IsNamed(vtkDataArray* array) { return array->GetName() && *array->GetName(); }
  /// The context of the buffer is current.
  void Release()
  {
    this->Shared.reset(); // before the buffer that it shares
    this->Pixels = nullptr;
    this->Context.reset();
  }

  vtkSmartPointer<vtkPixelBufferObject> Pixels;
  std::unique_ptr<OpenGLBuffer> Shared;
  std::optional<OpenGLContext> Context;
};

//------------------------------------------------------------------------------
vtkStandardNewMacro(vtkDeviceVolumeMapper);

//------------------------------------------------------------------------------
vtkDeviceVolumeMapper::vtkDeviceVolumeMapper()
  : Impl(std::make_unique<Internals>())
{
}

//------------------------------------------------------------------------------
vtkDeviceVolumeMapper::~vtkDeviceVolumeMapper()
{
  this->ReleaseGraphicsResources(nullptr); // of the window that it has drawn in, if any
}

//------------------------------------------------------------------------------
bool vtkDeviceVolumeMapper::ShareDevice(vtkRenderWindow* window, const char* device)
{
  auto* const openGLWindow = vtkOpenGLRenderWindow::SafeDownCast(window);
  if (!openGLWindow)
  {
    vtkErrorMacro("Memory of a device is shared with a window of OpenGL, which this is not.");
    return false;
  }
  openGLWindow->Initialize();
  openGLWindow->MakeCurrent();
  const std::optional<OpenGLContext> context = FindCurrentOpenGLContext();
  if (!context)
  {
    vtkErrorMacro("The window has no OpenGL context of GLX or EGL that is current.");
    return false;
  }
  try
  {
    ShareWithOpenGL(device ? device : "", *context);
  }
  catch (const std::exception& error)
  {
    vtkErrorMacro(<< error.what());
    return false;
  }
  return true;
}

//------------------------------------------------------------------------------
void vtkDeviceVolumeMapper::ReleaseGraphicsResources(vtkWindow* window)
{
  // The superclass has this called again, while the context of the window is current that it has
  // drawn in. Where it does not, that is the case already, or there is nothing to be released.
  this->Impl->IsReleased = false;
  this->Superclass::ReleaseGraphicsResources(window);
  if (!this->Impl->IsReleased)
  {
    this->Impl->Release();
    this->Impl->ReadyFor = nullptr;
    this->Impl->IsReleased = true;
  }
}

//------------------------------------------------------------------------------
void vtkDeviceVolumeMapper::GPURender(vtkRenderer* renderer, vtkVolume* volume)
{
  if (!this->Load(renderer, volume))
  {
    this->Impl->Loaded = nullptr;
    if (!this->LoadOnDevice && this->Impl->Pixels &&
      this->Impl->Pixels->GetContext() == renderer->GetRenderWindow())
    {
      renderer->GetRenderWindow()->MakeCurrent();
      this->Impl->Release(); // it is not needed any more
    }
  }
  this->Superclass::GPURender(renderer, volume);
  // What the superclass loads once more, for reasons of its own, it has read.
  const auto* const values = dynamic_cast<TextureValues*>(this->Impl->Loaded.Get());
  this->LoadedOnDevice = values && values->GetNumberOfReads() == 0;
  this->Impl->ReadyFor = this->GetInputCount() == 1 ? renderer->GetRenderWindow() : nullptr;
}

//------------------------------------------------------------------------------
bool vtkDeviceVolumeMapper::CanLoad(vtkRenderer* renderer, vtkVolume* volume, vtkImageData* input)
{
  // Surfaces and second dimensions of transfer functions are made on the host.
  const auto texture = this->AssembledInputs.find(0);
  return this->LoadOnDevice && this->Impl->ReadyFor &&
    this->Impl->ReadyFor == renderer->GetRenderWindow() && this->GetInputCount() == 1 &&
    !this->UseDepthPass &&
    volume->GetProperty()->GetTransferFunctionMode() == vtkVolumeProperty::TF_1D &&
    texture != this->AssembledInputs.end() && !HasPartitions(texture->second.Texture) &&
    !input->GetPointGhostArray() && !input->GetCellGhostArray();
}

//------------------------------------------------------------------------------
bool vtkDeviceVolumeMapper::Load(vtkRenderer* renderer, vtkVolume* volume)
{
  // The superclass draws a shallow copy of the input, whose arrays it reads as it updates its
  // texture.
  auto* const input = vtkImageData::SafeDownCast(this->GetTransformedInput(0));
  if (!input)
  {
    return false;
  }
  const auto getScalars = [&]() -> vtkDataArray*
  {
    int cellFlag = 0;
    vtkDataArray* const scalars = GetScalars(
      input, this->ScalarMode, this->ArrayAccessMode, this->ArrayId, this->ArrayName, cellFlag);
    return cellFlag == 0 ? scalars : nullptr;
  };
  const bool canLoad = this->CanLoad(renderer, volume, input);
  if (canLoad && this->Impl->Loaded && getScalars() == this->Impl->Loaded)
  {
    return true; // nothing is new but what is drawn of it
  }
  Internals::GiveBack(input);
  const vtkSmartPointer<vtkDataArray> scalars = getScalars(); // the input lets go of them
  if (!canLoad || !scalars || !this->CopyToBuffer(renderer, scalars))
  {
    return false;
  }
  Internals::Take(input);
  this->Impl->Loaded = getScalars();
  if (!this->LoadTexture(renderer, volume))
  {
    Internals::GiveBack(input);
    return false;
  }
  return true;
}

//------------------------------------------------------------------------------
bool vtkDeviceVolumeMapper::CopyToBuffer(vtkRenderer* renderer, vtkDataArray* scalars)
{
  const auto* const holder = dynamic_cast<DeviceOutputHolder*>(scalars);
  const std::shared_ptr<DeviceOutput> output = holder ? holder->GetDeviceOutput() : nullptr;
  const std::uint64_t bytes = static_cast<std::uint64_t>(scalars->GetNumberOfValues()) *
    static_cast<std::uint64_t>(scalars->GetDataTypeSize());
  if (!output || !Internals::IsNamed(scalars) || !IsTextureType(scalars->GetDataType()) ||
    bytes > std::numeric_limits<unsigned int>::max())
  {
    return false;
  }
  vtkRenderWindow* const window = renderer->GetRenderWindow();
  window->MakeCurrent();
  const std::optional<OpenGLContext> context = FindCurrentOpenGLContext();
  if (!context || !output->SharesWith(*context))
  {
    return false;
  }
  this->Impl->Reserve(window, *context, scalars);
  window->WaitForCompletion(); // before OpenCL has the buffer
  try
  {
    return output->CopyTo(*this->Impl->Shared);
  }
  catch (const std::exception& error)
  {
    this->Impl->Release();
    vtkWarningMacro(<< error.what() << " The volume is drawn by way of the host.");
    return false;
  }
}

//------------------------------------------------------------------------------
bool vtkDeviceVolumeMapper::LoadTexture(vtkRenderer* renderer, vtkVolume* volume)
{
  vtkDataArray* const loaded = this->Impl->Loaded;
  auto* const values = dynamic_cast<TextureValues*>(loaded);
  values->SetWithoutValues(true);
  const bool made = this->PreLoadData(renderer, volume);
  values->SetWithoutValues(false); // from here on they are read if the texture is made again
  if (!made || !this->Impl->Pixels)
  {
    return false;
  }
  vtkVolumeTexture* const texture = this->AssembledInputs.at(0).Texture;
  if (values->GetNumberOfRefusals() == 0)
  {
    // Blocks of a volume with partitions are loaded one by one, as they are drawn. Without an order
    // of these the texture cannot be made again.
    texture->SortBlocksBackToFront(renderer, volume->GetMatrix());
    return false;
  }
  const vtkVolumeTexture::VolumeBlock* const block = texture->GetCurrentBlock();
  const auto& size = block->TextureSize;
  auto* const window = static_cast<vtkOpenGLRenderWindow*>(renderer->GetRenderWindow());
  window->GetState()->vtkglPixelStorei(UnpackAlignment, 1);
  return block->TextureObject->Create3D(static_cast<unsigned int>(size[0]),
    static_cast<unsigned int>(size[1]), static_cast<unsigned int>(size[2]),
    loaded->GetNumberOfComponents(), this->Impl->Pixels, false);
}

//------------------------------------------------------------------------------
void vtkDeviceVolumeMapper::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "LoadOnDevice: " << (this->LoadOnDevice ? "on" : "off") << "\n";
  os << indent << "LoadedOnDevice: " << (this->LoadedOnDevice ? "true" : "false") << "\n";
}
