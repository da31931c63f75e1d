# SPDX-License-Identifier: BSD-3-Clause
"""A small deformation, for the tests of the wheel."""

import numpy

import deformvolume

SIZE = 16


def deform(shift=(0.0, 0.0, 0.0)):
    """Shifts a volume of random int16 by a mesh of five tetrahedra over the whole volume. shift: in voxels, along x, y
    and z. Returns the volume, the deformed volume on the same grid, with the background -1, and its coverage. The axes
    of these arrays are z, y, x."""
    volume = numpy.random.RandomState(1).randint(0, 1000, (SIZE, SIZE, SIZE)).astype(numpy.int16)
    last = SIZE - 1.0
    points = numpy.array([[last * (i & 1), last * (i >> 1 & 1), last * (i >> 2)] for i in range(8)])
    cells = numpy.array([[0, 1, 2, 4], [3, 2, 1, 7], [5, 4, 7, 1], [6, 7, 4, 2], [1, 2, 4, 7]])
    mesh = deformvolume.Mesh(points, cells, numpy.tile(shift, (8, 1)))
    result = deformvolume.deform(volume.T, mesh, bounds="volume", background=-1)
    return volume, result.array.T, result.coverage.T
