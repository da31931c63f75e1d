# SPDX-License-Identifier: BSD-3-Clause
"""Makes direction matrices with which a test notices any exchange of axes."""
import numpy


def turn(axis, degrees):
    """Returns the matrix of a rotation about an axis of the world."""
    c, s = numpy.cos(numpy.radians(degrees)), numpy.sin(numpy.radians(degrees))
    i, j = [other for other in range(3) if other != axis]
    matrix = numpy.eye(3)
    matrix[[i, j, i, j], [i, j, j, i]] = c, c, -s, s
    return matrix
