# SPDX-License-Identifier: BSD-3-Clause
"""A lattice of tetrahedra over a volume, for tests that move it."""

import numpy as np

import deformvolume_vtk
from vtkmodules.util.numpy_support import numpy_to_vtk


def make_mesh(image, nodes):
    """nodes: on each axis. Their displacements are 0."""
    source = deformvolume_vtk.vtkLatticeTetrahedraSource()
    source.SetNumberOfNodes(nodes, nodes, nodes)
    source.EqualSpacingOff()
    source.SetInputData(image)
    source.Update()
    mesh = source.GetOutput()
    made = numpy_to_vtk(np.zeros((mesh.GetNumberOfPoints(), 3), np.float32), deep=True)
    made.SetName("displacement")
    mesh.GetPointData().SetVectors(made)
    return mesh
