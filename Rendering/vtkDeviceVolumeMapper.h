// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkDeviceVolumeMapper
 * @brief   draw a deformed volume without reading it from the device
 *
 * vtkDeviceVolumeMapper is VTK's volume mapper for graphics cards, and draws the same pictures.
 * Where its input is the output of a vtkDeformVolumeFilter that stays on the device
 * (OutputOnDevice), and that device draws, too, the texture of the volume is filled there: from a
 * buffer that OpenCL and OpenGL share (extension cl_khr_gl_sharing of OpenCL). Otherwise the values
 * are read from the device and sent back to it.
 *
 * @code
 * vtkNew<vtkDeviceVolumeMapper> mapper;
 * mapper->ShareDevice(window);   // before the filter is updated
 * deform->OutputOnDeviceOn();
 * mapper->SetInputConnection(deform->GetOutputPort());
 * @endcode
 *
 * These are drawn by way of the host: the first picture in a window, and the first one after
 * ReleaseGraphicsResources() or a picture in another window; scalars of other types than signed
 * char, unsigned char, short, unsigned short and float, of cells, without a name, or of 4 GiB and
 * more; volumes with ghosts; several inputs or volumes of one mapper; partitions; UseDepthPass;
 * transfer functions of two dimensions. So are outputs of filters on other devices, and those that
 * somebody has read: their values are on the host already. GetLoadedOnDevice() tells.
 *
 * The device has another copy of the scalars then, in the buffer. Other arrays of the output stay
 * on the device, too, as long as nobody but this mapper holds them.
 *
 * @par Errors:
 * Where a copy on the device fails, that is a warning, and the values are read.
 *
 * @sa vtkDeformVolumeFilter vtkOpenGLGPUVolumeRayCastMapper
 */
#ifndef vtkDeviceVolumeMapper_h
#define vtkDeviceVolumeMapper_h

#include "vtkDeformVolumeRenderingModule.h" // for export macro
#include "vtkOpenGLGPUVolumeRayCastMapper.h"

#include <memory> // for std::unique_ptr

class vtkRenderWindow;

class VTKDEFORMVOLUMERENDERING_EXPORT vtkDeviceVolumeMapper : public vtkOpenGLGPUVolumeRayCastMapper
{
public:
  static vtkDeviceVolumeMapper* New();
  vtkTypeMacro(vtkDeviceVolumeMapper, vtkOpenGLGPUVolumeRayCastMapper);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  /**
   * Has a device share its memory with a window, for all filters and mappers of this process. To be
   * called before any filter uses the device, which can share with one window only. Called again
   * for the two it does nothing. The window is initialized, and its context is current afterwards:
   * one of GLX or EGL. That of a vtkGenericOpenGLRenderWindow has to be current before.
   *
   * The OpenGL context of the window has to be there for as long as filters use the device, or else
   * what these do is undefined: do not close the window before, nor have its context made anew, as
   * Finalize(), full screen, or a widget that gets another parent do.
   *
   * device: as for vtkDeformVolumeFilter::SetDevice(), "" is the best one.
   *
   * Returns whether they share. Otherwise an error says why: there is no such device, it lacks the
   * extension cl_khr_gl_sharing, is not the one that draws, or is in use already. What this mapper
   * draws then goes by way of the host.
   */
  bool ShareDevice(vtkRenderWindow* window, const char* device = "");

  ///@{
  /**
   * Whether the texture is filled on the device where that is possible. Default: on.
   */
  vtkSetMacro(LoadOnDevice, bool);
  vtkGetMacro(LoadOnDevice, bool);
  vtkBooleanMacro(LoadOnDevice, bool);
  ///@}

  /**
   * Whether the texture of the last picture was filled on the device.
   */
  vtkGetMacro(LoadedOnDevice, bool);

  /**
   * Lets go of what belongs to a window.
   */
  void ReleaseGraphicsResources(vtkWindow* window) override;

protected:
  vtkDeviceVolumeMapper();
  ~vtkDeviceVolumeMapper() override;

  void GPURender(vtkRenderer* renderer, vtkVolume* volume) override;

private:
  vtkDeviceVolumeMapper(const vtkDeviceVolumeMapper&) = delete;
  void operator=(const vtkDeviceVolumeMapper&) = delete;

  /// Fills the texture on the device, unless it has been. Returns false where that is not possible;
  /// then the input is as it was.
  bool Load(vtkRenderer* renderer, vtkVolume* volume);
  bool CanLoad(vtkRenderer* renderer, vtkVolume* volume, vtkImageData* input);
  /// Copies the values of an array to the buffer that OpenCL and OpenGL share.
  bool CopyToBuffer(vtkRenderer* renderer, vtkDataArray* scalars);
  /// Makes the texture from that buffer.
  bool LoadTexture(vtkRenderer* renderer, vtkVolume* volume);

  class Internals;
  std::unique_ptr<Internals> Impl;
  bool LoadOnDevice = true;
  bool LoadedOnDevice = false;
};

#endif
