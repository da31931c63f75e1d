# SPDX-License-Identifier: BSD-3-Clause
"""Draws architecture.png: /usr/bin/python3 architecture.py (needs python3-matplotlib)."""
import pathlib

import matplotlib
matplotlib.use("Agg")
import matplotlib.pyplot as plt

BLUE, ORANGE, GREY, GREEN = "#1f6fb4", "#d9731a", "#6a6a6a", "#3a8f4d"

figure, axes = plt.subplots(figsize=(11, 6.4))
axes.set_axis_off()
axes.set_xlim(0, 110)
axes.set_ylim(0, 66)


def room(x, y, width, height, title, color):
    axes.add_patch(plt.Rectangle((x, y), width, height, facecolor=color, alpha=0.09, edgecolor=color))
    axes.text(x + 1, y + height - 2.2, title, fontsize=11, color=color, weight="bold")


def box(x, y, width, height, name, text, color, classes=""):
    axes.add_patch(plt.Rectangle((x, y), width, height, facecolor="white", edgecolor=color, linewidth=1.3))
    axes.text(x + width / 2, y + height - 1.9, name, ha="center", fontsize=9.5, weight="bold")
    axes.text(x + width / 2, y + height - 3.9, classes, ha="center", fontsize=8, color=color)
    top = 4.2 if classes else 2.6
    axes.text(x + width / 2, y + (height - top) / 2, text, ha="center", va="center", fontsize=8.2)


def arrow(start, end, text="", color=GREY, place=(0, 0)):
    axes.annotate("", end, start, arrowprops={"arrowstyle": "-|>", "color": color, "linewidth": 1.4})
    if text:
        axes.text((start[0] + end[0]) / 2 + place[0], (start[1] + end[1]) / 2 + place[1], text,
                  ha="center", fontsize=8, color=color)


room(0, 2, 14, 62, "pipeline", GREY)
room(17, 2, 31, 62, "Filters (VTK)", BLUE)
room(51, 2, 59, 62, "Kernels (the engine)", ORANGE)

box(1, 45, 12, 9, "port 0", "the volume\n(vtkImageData)", GREY)
box(1, 28, 12, 12, "ports 1, 2", "the deformation:\nmesh or field,\nmesh at rest", GREY)
box(1, 6, 12, 9, "output", "the deformed\nvolume", GREY)

# Folders, with the class to begin with.
box(18.5, 44, 28, 11, "Arrays, Pipeline", "which arrays, of which type;\nextent, spacing, direction", BLUE, "VolumeArrays, PipelineGeometry")
box(18.5, 27, 28, 14, "DeformationMesh, Displacements", "cells split into tetrahedra, nodes at rest,\ndisplacements in output voxels;\nwhat has changed since the last update", BLUE, "DeformationMesh, Deformation")
box(18.5, 5, 28, 12, "Output", "memory of the output,\nnew or that of the last one", BLUE, "OutputArrays")

box(53, 44, 24, 11, "StaticMapping", "the tetrahedron of each voxel and\nits weights; on the host,\nonce for a mesh at rest", ORANGE, "StaticMapping")
box(84, 44, 24, 11, "DeviceVolume", "arrays, links or runs, masks,\nstates of vertices;\non the device", ORANGE, "DeviceVolume")
box(53, 28, 24, 12, "Displacements", "displacements of nodes\nor of a field, on the device;\nwhich of them change", ORANGE, "DisplacementSource")
box(53, 17.5, 24, 8, "Incremental", "which bricks these can change", ORANGE, "IncrementalOutput")
box(53, 5, 24, 8, "World", "where the deformed volume lies", ORANGE, "OutputExtent")
box(84, 27, 24, 13, "Resampling, Rasterization", "kernels: positions of vertices,\nthen the samples in\neach tetrahedron", ORANGE, "ExactResampler, MeshRasterizer")
box(84, 9, 24, 11, "Output", "planes of the output with their\ncoverage and winners", ORANGE, "OutputSlab")

arrow((13, 49.5), (18.5, 49.5))
arrow((13, 34), (18.5, 34))
arrow((46.5, 39), (53, 46), "at rest", BLUE, (0.9, -2.6))
axes.plot((32.5, 32.5, 96), (55, 58, 58), color=BLUE, linewidth=1.4)
arrow((96, 58), (96, 55), color=BLUE)
axes.text(73, 58.8, "values, where they lie", ha="center", fontsize=8, color=BLUE)
arrow((77, 49.5), (84, 49.5))
arrow((46.5, 34), (53, 34), "now", BLUE, (0, 1.0))
arrow((77, 34), (84, 34))
arrow((65, 28), (65, 25.5))
arrow((77, 22), (86, 27), "bricks", GREY, (-0.6, -2.6))
arrow((96, 44), (96, 40))
arrow((96, 27), (96, 20))
arrow((84, 15.2), (46.5, 15.2), "values, covered voxels, counts", BLUE, (-1.5, 0.5))
arrow((45, 27), (53, 12), "bounds", BLUE, (-3.4, 1.0))
arrow((53, 7), (46.5, 7), "extent", BLUE, (0, -2.0))
arrow((18.5, 10.5), (13, 10.5))

figure.tight_layout(pad=0.3)
figure.savefig(pathlib.Path(__file__).with_name("architecture.png"), dpi=100)
