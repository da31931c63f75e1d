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
#include "vtkVolumeInputHelper.h"
#include "vtkVolumeTexture.h"

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
  /// Whether the superclass has what it needs for the window: else it loads the texture again.
  bool IsReady = false;

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
  /// The input has the scalars again that were taken from it.
  void GiveBack(vtkImageData* input)
  {
    const auto* const values = dynamic_cast<TextureValues*>(this->Loaded.Get());
    if (values && values->GetValues() &&
      input->GetPointData()->GetArray(this->Loaded->GetName()) == this->Loaded)
    {
      input->GetPointData()->AddArray(values->GetValues());
    }
  }
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
  if (this->Impl->Pixels && this->Impl->Pixels->GetContext())
  {
    this->Impl->Pixels->GetContext()->MakeCurrent();
  }
  this->Impl->Release();
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
  this->Impl->Release();
  this->Impl->IsReady = false;
  this->Superclass::ReleaseGraphicsResources(window);
}

//------------------------------------------------------------------------------
void vtkDeviceVolumeMapper::GPURender(vtkRenderer* renderer, vtkVolume* volume)
{
  if (!this->Load(renderer, volume))
  {
    this->Impl->Loaded = nullptr;
  }
  this->Superclass::GPURender(renderer, volume);
  // What the superclass loads once more, for reasons of its own, it has read.
  const auto* const values = dynamic_cast<TextureValues*>(this->Impl->Loaded.Get());
  this->LoadedOnDevice = values && values->GetNumberOfReads() == 0;
  this->Impl->IsReady = true;
}

//------------------------------------------------------------------------------
bool vtkDeviceVolumeMapper::CanLoad(vtkImageData* input)
{
  const auto texture = this->AssembledInputs.find(0);
  return this->LoadOnDevice && this->Impl->IsReady && this->GetInputCount() == 1 &&
    !this->UseDepthPass && texture != this->AssembledInputs.end() &&
    !HasPartitions(texture->second.Texture) && !input->GetPointGhostArray() &&
    !input->GetCellGhostArray();
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
  int cellFlag = 0;
  vtkDataArray* const scalars = GetScalars(
    input, this->ScalarMode, this->ArrayAccessMode, this->ArrayId, this->ArrayName, cellFlag);
  if (!scalars || cellFlag != 0 || !this->CanLoad(input))
  {
    this->Impl->GiveBack(input);
    return false;
  }
  if (scalars == this->Impl->Loaded)
  {
    return true; // nothing is new but what is drawn of it
  }
  const vtkSmartPointer<vtkDataArray> given = scalars; // the input lets go of it
  if (!this->CopyToBuffer(renderer, given))
  {
    return false;
  }
  this->Impl->Loaded = MakeTextureValues(given);
  // In the place of that of the same name, whatever the mapper chooses its scalars by.
  input->GetPointData()->AddArray(this->Impl->Loaded);
  if (!this->LoadTexture(renderer, volume))
  {
    this->Impl->GiveBack(input);
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
  const char* const name = scalars->GetName();
  if (!output || !name || !*name || bytes > std::numeric_limits<unsigned int>::max() ||
    !MakeTextureValues(scalars))
  {
    return false;
  }
  vtkRenderWindow* const window = renderer->GetRenderWindow();
  window->MakeCurrent();
  const std::optional<OpenGLContext> context = FindCurrentOpenGLContext();
  if (!context)
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
  if (!made)
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
