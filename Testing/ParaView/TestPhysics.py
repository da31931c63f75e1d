# SPDX-License-Identifier: BSD-3-Clause
"""Tests Mass-Spring and Finite-Element Deformation with handles, materials and times, and Deform Volume with their
output."""

import deformvolume_vtk  # noqa: F401, the classes of the objects on the server
from paraview import simple
from PluginTesting import load_plugin

FIX = """
import vtk
output.ShallowCopy(self.GetInput())
fixed = vtk.vtkUnsignedCharArray()
fixed.SetName("Fixed")
for i in range(output.GetNumberOfPoints()):
    fixed.InsertNextValue(output.GetPoint(i)[2] == -10)
output.GetPointData().AddArray(fixed)
"""


def largest(proxy):
    proxy.UpdatePipeline()
    return proxy.PointData["Displacement"].GetRange(-1)[1]


def check_elements(volume, mesh, handle):
    fem = simple.FiniteElementDeformation(RestMesh=mesh, Handles=handle)
    fem.Mode = "Converged"
    fem.YoungModulus = 5000
    fem.ElementResults = 1
    assert abs(largest(fem) - 4.0) < 1e-6
    assert fem.InEquilibrium == 1, fem.Summary
    assert fem.CellData["Stress"].GetNumberOfComponents() == 6
    assert "in equilibrium" in fem.Summary, fem.Summary
    made = fem.GetClientSideObject()
    assert made.GetYoungModulus() == 5000
    deformed = simple.DeformVolume(Volume=volume, Deformation=fem)
    deformed.UpdatePipeline()
    bounds = deformed.GetDataInformation().GetBounds()
    assert bounds[5] > 13.0, bounds
    # Information properties are those of the last update.
    handle.Position = [0, 0, 11]
    assert abs(largest(fem) - 1.0) < 1e-6
    handle.Position = [0, 0, 14]
    simple.Delete(deformed)
    simple.Delete(fem)


def check_materials(volume, mesh):
    """Tests materials from a volume, whose values are from 37 to 277, with the largest ones in the middle."""
    materials = simple.MaterialFromVolume(Mesh=mesh, Volume=volume)
    materials.DefaultMaterial = 1
    materials.Materials = [1, 2000, 0.2, 900, 9, 8000, 0.4, 1100]
    materials.MaterialRanges = [150, 1000, 9]
    materials.UpdatePipeline()
    young = materials.CellData["YoungModulus"].GetRange()
    assert 2000 <= young[0] < 2500 and 7000 < young[1] <= 8000, young
    density = materials.CellData["Density"].GetRange()
    assert 900 <= density[0] < density[1] <= 1100, density
    assert materials.TetrahedraWithoutVoxels == 0
    assert materials.TetrahedraOutside == 0
    simple.Delete(materials)


def check_springs(mesh, handle):
    springs = simple.MassSpringDeformation(RestMesh=mesh, Handles=handle)
    springs.LengthUnit = "Millimetre"
    springs.EndTime = 0.2
    springs.UpdatePipelineInformation()
    scene = simple.GetAnimationScene()
    scene.UpdateAnimationUsingDataTimeSteps()
    assert scene.EndTime == 0.2, scene.EndTime
    springs.UpdatePipeline(0.0)
    assert springs.PointData["Displacement"].GetRange(-1)[1] == 0.0
    springs.UpdatePipeline(0.1)
    assert abs(springs.Time - 0.1) < 1e-9, springs.Time
    moved = springs.PointData["Displacement"].GetRange(-1)
    assert moved[1] >= 4.0, moved
    assert 0 < springs.TimeStepInUse < springs.StableTimeStep
    # Go back to the start, and play again.
    springs.UpdatePipeline(0.0)
    assert springs.PointData["Displacement"].GetRange(-1)[1] == 0.0
    springs.UpdatePipeline(0.1)
    assert springs.PointData["Displacement"].GetRange(-1) == moved
    # Cut the body, and remove the cut.
    springs.Sheet = simple.Plane(Origin=[0.1, -50, -50], Point1=[0.1, 50, -50], Point2=[0.1, -50, 50])
    springs.UpdatePipeline(0.1)
    made = springs.GetClientSideObject()
    assert made.GetNumberOfCuts() == 1
    assert springs.GetDataInformation().GetNumberOfPoints() == 125 + 25
    springs.UndoCut()
    springs.UpdatePipeline(0.1)
    assert springs.GetDataInformation().GetNumberOfPoints() == 125
    simple.Delete(springs)


def main():
    load_plugin()
    volume = simple.Wavelet()  # 21 x 21 x 21 voxels around the origin
    lattice = simple.TetrahedralLattice(NumberOfNodes=[5, 5, 5], Bounds=[-10, 10] * 3)
    mesh = simple.ProgrammableFilter(Input=lattice)
    mesh.OutputDataSetType = "vtkUnstructuredGrid"
    mesh.Script = FIX
    handle = simple.DeformationHandle(RestPosition=[0, 0, 10], Position=[0, 0, 14])
    check_elements(volume, mesh, handle)
    check_materials(volume, mesh)
    check_springs(mesh, handle)


main()
