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


def box(x, y, width, height, name, text, color):
    axes.add_patch(plt.Rectangle((x, y), width, height, facecolor="white", edgecolor=color, linewidth=1.3))
    axes.text(x + width / 2, y + height - 1.9, name, ha="center", fontsize=9.5, weight="bold")
    axes.text(x + width / 2, y + (height - 2.6) / 2, text, ha="center", va="center", fontsize=8.2)


def arrow(start, end, text="", color=GREY, place=(0, 0)):
    axes.annotate("", end, start, arrowprops={"arrowstyle": "-|>", "color": color, "linewidth": 1.4})
    if text:
        axes.text((start[0] + end[0]) / 2 + place[0], (start[1] + end[1]) / 2 + place[1], text,
                  ha="center", fontsize=8, color=color)


room(0, 2, 14, 62, "pipeline", GREY)
room(17, 2, 31, 62, "Filters (VTK)", BLUE)
room(51, 2, 59, 62, "Kernels (the engine)", ORANGE)

box(1, 43, 12, 9, "port 0", "the volume\n(vtkImageData)", GREY)
box(1, 25, 12, 11, "ports 1, 2", "the deformation:\nmesh or field,\nmesh at rest", GREY)
box(1, 6, 12, 9, "output", "the deformed\nvolume", GREY)

box(18.5, 43, 28, 10, "VolumeArrays, ImageGeometry", "which arrays, of which type;\nextent, spacing, direction", BLUE)
box(18.5, 25, 28, 12, "Deformation", "cells split into tetrahedra, nodes at rest,\ndisplacements in output voxels;\nwhat has changed since the last update", BLUE)
box(18.5, 6, 28, 11, "OutputExtent, OutputArrays", "where the deformed volume lies;\nmemory of the output, new or the last one", BLUE)

box(53, 43, 24, 10, "Mapping: StaticMapping", "the tetrahedron of each voxel\nand its weights; on the host,\nonce for a mesh at rest", ORANGE)
box(84, 43, 24, 10, "Mapping: DeviceVolume", "arrays, links or runs, masks,\nstates of vertices;\non the device", ORANGE)
box(53, 25, 24, 12, "Mapping: DisplacementSource", "displacements of nodes\nor of a field, on the device;\nwhich of them change", ORANGE)
box(53, 12, 24, 8.5, "IncrementalOutput", "which bricks of cells these\ncan change", ORANGE)
box(84, 25, 24, 12, "SlabResampler", "kernels: positions of vertices,\nthen the samples in each\ntetrahedron (ExactResampler);\nor by MeshRasterizer", ORANGE)
box(84, 6, 24, 11, "Resampling: OutputSlab", "planes of the output with their\ncoverage and winners", ORANGE)

arrow((13, 47.5), (18.5, 47.5))
arrow((13, 30.5), (18.5, 30.5))
arrow((46.5, 35), (53, 44.5), "at rest", BLUE, (-2.2, 0.8))
axes.plot((32.5, 32.5, 96), (53, 55.5, 55.5), color=BLUE, linewidth=1.4)
arrow((96, 55.5), (96, 53), color=BLUE)
axes.text(73, 56.2, "values, where they lie", ha="center", fontsize=8, color=BLUE)
arrow((77, 48), (84, 48))
arrow((46.5, 30), (53, 30), "now", BLUE, (0, 1.0))
arrow((77, 31), (84, 31))
arrow((65, 25), (65, 20.5))
arrow((77, 17.5), (86, 25), "bricks", GREY, (-2.2, 0.6))
arrow((96, 43), (96, 37))
arrow((96, 25), (96, 17))
arrow((84, 8.5), (46.5, 8.5), "values, covered voxels, counts", BLUE, (0, -2.4))
arrow((18.5, 10.5), (13, 10.5))
arrow((32.5, 25), (32.5, 17))

figure.tight_layout(pad=0.3)
figure.savefig(pathlib.Path(__file__).with_name("architecture.png"), dpi=100)
