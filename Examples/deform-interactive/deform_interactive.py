# SPDX-License-Identifier: BSD-3-Clause
"""Drags, cuts and carves a volume interactively: deform_interactive.py VOLUME.nii.gz [EVENTS.log SESSION.xml]
Press 2 for ChainMail, g to grab, and h for all keys. EVENTS.log is a recording of vtkInteractorEventRecorder:
its events are replayed, and the session is saved to SESSION.xml."""
import sys

import deformvolume_vtk
import vtkmodules.vtkRenderingFreeType  # noqa: F401 (draws texts)
import vtkmodules.vtkRenderingVolumeOpenGL2  # noqa: F401 (draws volumes)
from vtkmodules import vtkIOImage, vtkRenderingCore, vtkRenderingVolume

if len(sys.argv) not in (2, 4):
    sys.exit(__doc__)
reader = vtkIOImage.vtkNIFTIImageReader()
reader.SetFileName(sys.argv[1])
reader.Update()
volume = vtkRenderingCore.vtkVolume()
volume.SetMapper(vtkRenderingVolume.vtkGPUVolumeRayCastMapper())
opacity = volume.GetProperty().GetScalarOpacity()
opacity.RemoveAllPoints()  # VTK's default makes air opaque
opacity.AddPoint(25.0, 0.0)
opacity.AddPoint(55.0, 0.9)
colors = volume.GetProperty().GetRGBTransferFunction()
colors.RemoveAllPoints()
colors.AddRGBPoint(25.0, 0.9, 0.7, 0.6)
volume.GetProperty().ShadeOn()
renderer = vtkRenderingCore.vtkRenderer()
renderer.AddVolume(volume)
window = vtkRenderingCore.vtkRenderWindow()
window.SetSize(800, 600)
window.AddRenderer(renderer)
interactor = vtkRenderingCore.vtkRenderWindowInteractor()
interactor.SetRenderWindow(window)

session = deformvolume_vtk.vtkDeformVolumeSession()
session.SetInputs(reader.GetOutput())
style = deformvolume_vtk.vtkDeformVolumeInteractorStyle()
style.SetSession(session)
style.SetVolume(volume)
interactor.SetInteractorStyle(style)
interactor.Initialize()
style.Poll()  # draws the volume at rest
renderer.ResetCamera()
if len(sys.argv) < 4:
    style.StartSession()
    interactor.Start()
    style.StopSession()
else:
    recorder = vtkRenderingCore.vtkInteractorEventRecorder()
    recorder.SetInteractor(interactor)
    recorder.SetFileName(sys.argv[2])
    recorder.EnabledOn()
    recorder.Play()
    recorder.EnabledOff()
    sys.exit(0 if session.SaveSession(sys.argv[3]) else 1)
