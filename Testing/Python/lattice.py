# SPDX-License-Identifier: BSD-3-Clause
"""Makes a lattice of tetrahedra over a volume."""

import numpy as np

import deformvolume_vtk
from vtkmodules.util.numpy_support import numpy_to_vtk


def make_mesh(image, nodes):
    """Returns a lattice with displacements of 0. nodes: the number of nodes on each axis."""
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
