# SPDX-License-Identifier: BSD-3-Clause
"""Reads numbers from the text of vtkDeformVolumeFilter.GetSummary()."""


def reported(deform, name):
    """Returns the number in the line "name: number"; 0 before the first execution."""
    lines = dict(line.split(": ", 1) for line in deform.GetSummary().splitlines())
    return float(lines[name].replace(",", "")) if lines else 0
