# SPDX-License-Identifier: BSD-3-Clause
"""Deforms a volume in pvbatch and saves the result: data as <prefix>.pvti, a picture as <prefix>.png.
The volume that is cut, carved and dragged by ChainMail is saved as <prefix>-edited.pvti, and deformed by
these displacements as <prefix>-dragged.pvti.

Arguments: the plugin, the prefix, the volume (.vti), the deformation mesh (.pvtu), the expected number of ranks.
"""
import sys

from paraview import servermanager, simple

plugin, prefix, volume_file, mesh_file, ranks = sys.argv[1:]
simple.LoadPlugin(plugin, remote=False, ns=globals())
if servermanager.vtkProcessModule.GetProcessModule().GetNumberOfLocalPartitions() != int(ranks):
    sys.exit(f"pvbatch does not run on {ranks} ranks")

volume = simple.XMLImageDataReader(FileName=[volume_file])
lattice = TetrahedralLattice(NumberOfNodes=[7, 7, 7], EqualSpacing=False, Bounds=[-32, 32, -31, 31, -33, 33])
lattice.UpdatePipeline()
if lattice.GetDataInformation().GetNumberOfCells() != 5 * 6**3:
    sys.exit(f"on {ranks} ranks the lattice has {lattice.GetDataInformation().GetNumberOfCells()} cells, "
             f"not {5 * 6**3}")
# ParaView distributes the pieces of the file over the ranks.
mesh = simple.XMLPartitionedUnstructuredGridReader(FileName=[mesh_file])
deformed = DeformVolume(Volume=volume, Deformation=mesh)
deformed.DisplacementArray = ["POINTS", "displacement"]
deformed.UpdatePipeline()
simple.SaveData(prefix + ".pvti", proxy=deformed, DataMode="Binary")

sheet = simple.Plane(Origin=[0.3, -40, -40], Point1=[0.3, 40, -40], Point2=[0.3, -40, 40])
carved = CarveVolume(Volume=CutVolume(Volume=volume, Sheet=sheet))
carved.Body = "Sphere"
carved.Body.Center, carved.Body.Radius = [9, 7, -5], 8
simple.SaveData(prefix + "-edited.pvti", proxy=carved, DataMode="Binary")
handle = DeformationHandle(RestPosition=[4, -6, 2], Position=[13, 2, 8])
drag = ChainMailDeformation(Volume=carved, Handles=handle, RelaxationSweeps=3)
drag.UpdatePipeline()  # ranks request pieces here, but the whole below: together this is one step
dragged = DeformVolume(Volume=carved, Deformation=drag)
simple.SaveData(prefix + "-dragged.pvti", proxy=dragged, DataMode="Binary")

view = simple.CreateView("RenderView")
view.ViewSize = [400, 400]
view.OrientationAxesVisibility = 0
display = simple.Show(deformed, view)
display.SetRepresentationType("Volume")
simple.ColorBy(display, ("POINTS", "RTData"))
colors = simple.GetColorTransferFunction("RTData")
colors.RescaleTransferFunction(40.0, 280.0)
simple.GetOpacityTransferFunction("RTData").Points = [40, 0, 0.5, 0, 120, 0.02, 0.5, 0, 280, 0.6, 0.5, 0]
display.SetScalarBarVisibility(view, False)
view.CameraPosition = [110, 90, 150]
view.CameraFocalPoint = [0, 0, 0]
view.CameraViewUp = [0, 1, 0]
simple.Render(view)
simple.SaveScreenshot(prefix + ".png", view, ImageResolution=[400, 400])
