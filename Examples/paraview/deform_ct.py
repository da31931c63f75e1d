# SPDX-License-Identifier: BSD-3-Clause
"""Deforms a CT in ParaView by one filter. Only the array of displacements must be chosen.

pvbatch deform_ct.py PLUGIN CT MESH ARRAY PICTURE

PLUGIN is DeformVolume.so, CT a volume in Hounsfield units (.vti), MESH a mesh of tetrahedra (.vtu) in the coordinates
of the CT, ARRAY the name of the mesh's point array of displacements, and PICTURE the .png file to write."""

import sys

from paraview.simple import *

plugin, ct_file, mesh_file, array, picture = sys.argv[1:]
LoadPlugin(plugin, remote=False, ns=globals())
ct = OpenDataFile(ct_file)
mesh = OpenDataFile(mesh_file)
# The defaults of DeformVolume (arrays, background) depend on the data.
ct.UpdatePipeline()
mesh.UpdatePipeline()

deformed = DeformVolume(Volume=ct, Deformation=mesh)
deformed.DisplacementArray = ["POINTS", array]

view = GetActiveViewOrCreate("RenderView")
view.ViewSize = [400, 400]
view.UseColorPaletteForBackground = 0
view.Background = [0.1, 0.12, 0.15]
view.OrientationAxesVisibility = 0
shown = Show(deformed, view)  # as a volume
scalars = shown.ColorArrayName[1]
colors = GetColorTransferFunction(scalars)
colors.ColorSpace = "RGB"
# Hounsfield units: fat, soft tissue and bone.
colors.RGBPoints = [-150, 0.9, 0.6, 0.4, 60, 0.8, 0.3, 0.25, 300, 1.0, 1.0, 0.9]
# Each point: value, opacity, midpoint and sharpness.
opacity = GetOpacityTransferFunction(scalars)
opacity.Points = [-300, 0, 0.5, 0, 0, 0.05, 0.5, 0, 150, 0.1, 0.5, 0, 400, 0.9, 0.5, 0]
# View from the front, which is at the minimum of y.
bounds = ct.GetDataInformation().GetBounds()
middle = [0.5 * (bounds[2 * i] + bounds[2 * i + 1]) for i in range(3)]
height = bounds[5] - bounds[4]
view.CameraFocalPoint = middle
view.CameraPosition = [middle[0] + height, middle[1] - 2 * height, middle[2] + 0.5 * height]
view.CameraViewUp = [0, 0, 1]
SaveScreenshot(picture, view, ImageResolution=[400, 400])
print(deformed.Summary)
