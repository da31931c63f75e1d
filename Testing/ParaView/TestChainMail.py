# SPDX-License-Identifier: BSD-3-Clause
"""Tests ChainMail Deformation with handles, materials and ranges, and Deform Volume with its output."""

import deformvolume_vtk  # noqa: F401, the class of the object on the server
from paraview import simple
from PluginTesting import load_plugin

HANDLES = """
import vtk
points = vtk.vtkPoints()
points.InsertNextPoint(%s, 0, 0)
output.SetPoints(points)
rest = vtk.vtkDoubleArray()
rest.SetName("RestPosition")
rest.SetNumberOfComponents(3)
rest.InsertNextTuple((0, 0, 0))
output.GetPointData().AddArray(rest)
"""


def main():
    load_plugin()
    volume = simple.Wavelet()  # 21 x 21 x 21 voxels, values over 37
    handles = simple.ProgrammableSource()
    handles.OutputDataSetType = "vtkPolyData"
    handles.Script = HANDLES % 3
    drag = simple.ChainMailDeformation(Volume=volume, Handles=handles)
    made = drag.GetClientSideObject()
    assert made.GetNumberOfMaterials() == 5
    drag.RelaxationSweeps = 0
    drag.DefaultMaterial = 2
    drag.Materials = [2, 0.5, 1.5, 0.5, 7, 0.75, 1.25, 0.25]
    deformed = simple.DeformVolume(Volume=volume, Deformation=drag)
    deformed.UpdatePipeline()
    assert made.GetNumberOfMaterials() == 2
    assert drag.PointData["Displacement"].GetRange(0) == (0.0, 3.0)
    assert made.GetNumberOfMovedVoxels() == 231, made.GetNumberOfMovedVoxels()
    assert "Voxels moved: 231" in drag.Summary, drag.Summary
    # Ranges: the whole volume is stiffer, so more voxels move.
    drag.MaterialRanges = [0, 1000, 7]
    handles.Script = HANDLES % 4
    drag.Reset()
    deformed.UpdatePipeline()
    assert made.GetNumberOfMaterialRanges() == 1
    assert drag.PointData["Displacement"].GetRange(0) == (0.0, 4.0)
    assert made.GetNumberOfMovedVoxels() > 2000, made.GetNumberOfMovedVoxels()
    # The same handle, from the source that has widgets.
    whole = drag.PointData["Displacement"].GetRange(-1), made.GetNumberOfMovedVoxels()
    drag.Handles = simple.DeformationHandle(RestPosition=[0, 0, 0], Position=[4, 0, 0])
    drag.Reset()
    deformed.UpdatePipeline()
    assert (drag.PointData["Displacement"].GetRange(-1), made.GetNumberOfMovedVoxels()) == whole
    # Without handles the volume returns to rest.
    drag.Handles = None
    drag.Reset()
    deformed.UpdatePipeline()
    assert drag.PointData["Displacement"].GetRange(0) == (0.0, 0.0)


main()
