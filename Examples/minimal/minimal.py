# SPDX-License-Identifier: BSD-3-Clause
"""A minimal program that deforms a volume: minimal.py IN.vti OUT.vti
bends the volume along x by a sine of z. The amplitude is a tenth of the height of the volume."""
import sys

import deformvolume_vtk
from vtkmodules.vtkFiltersCore import vtkArrayCalculator
from vtkmodules.vtkIOXML import vtkXMLImageDataReader, vtkXMLImageDataWriter

if len(sys.argv) != 3:
    sys.exit("usage: minimal.py IN.vti OUT.vti")

reader = vtkXMLImageDataReader()
reader.SetFileName(sys.argv[1])

mesh = deformvolume_vtk.vtkLatticeTetrahedraSource()
mesh.SetInputConnection(reader.GetOutputPort())
mesh.SetNumberOfNodes(20, 20, 20)

reader.Update()
bounds = reader.GetOutput().GetBounds()
height = bounds[5] - bounds[4]
displacement = vtkArrayCalculator()
displacement.SetInputConnection(mesh.GetOutputPort())
displacement.AddCoordinateScalarVariable("z", 2)
displacement.SetFunction(f"0.1 * {height} * sin(6.2832 * z / {height}) * iHat")
displacement.SetResultArrayName("Displacement")

deform = deformvolume_vtk.vtkDeformVolumeFilter()
deform.SetInputConnection(reader.GetOutputPort())
deform.SetDeformationConnection(displacement.GetOutputPort())
deform.SetInputArrayToProcess(0, 1, 0, 0, "Displacement")

writer = vtkXMLImageDataWriter()
writer.SetDataModeToBinary()
writer.SetInputConnection(deform.GetOutputPort())
writer.SetFileName(sys.argv[2])
if not writer.Write() or deform.GetNumberOfCoveredVoxels() == 0:
    sys.exit(f"cannot deform {sys.argv[1]} into {sys.argv[2]}")
print(f"{deform.GetNumberOfCoveredVoxels()} voxels covered on {deform.GetDeviceInUse()}")
