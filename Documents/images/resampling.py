# SPDX-License-Identifier: BSD-3-Clause
"""Draws resampling.png: /usr/bin/python3 resampling.py (needs python3-matplotlib)."""
import pathlib

import matplotlib
matplotlib.use("Agg")
import matplotlib.pyplot as plt

BLUE, ORANGE, GREY = "#1f6fb4", "#d9731a", "#8a8a8a"


def draw_cell(axes):
    """A face of the central tetrahedron, the corner behind it, and a sample there."""
    corner = {0: (0, 0), 1: (3, 0), 4: (0.9, 1.1), 5: (3.9, 1.1),
              2: (0, 3), 3: (3, 3), 6: (0.9, 4.1), 7: (3.9, 4.1)}
    edges = [(0, 1), (0, 2), (0, 4), (1, 3), (1, 5), (2, 3), (2, 6), (3, 7), (4, 5), (4, 6), (5, 7), (6, 7)]
    for a, b in edges:
        axes.plot(*zip(corner[a], corner[b]), color=GREY, linewidth=1)
    for a, b in [(0, 3), (0, 5), (0, 6), (3, 5), (3, 6), (5, 6)]:
        axes.plot(*zip(corner[a], corner[b]), color=BLUE, linewidth=1.8)
    axes.fill(*zip(corner[3], corner[5], corner[6]), color=BLUE, alpha=0.15)
    axes.fill(*zip(corner[3], corner[5], corner[7], corner[6]), color=ORANGE, alpha=0.18)
    for vertex, place in corner.items():
        central = vertex in (0, 3, 5, 6)
        axes.plot(*place, "o", color=BLUE if central else ORANGE, markersize=6)
        axes.annotate(f"{'t' if central else 'u'}{vertex}", place, textcoords="offset points",
                      xytext=(-17, -12) if vertex in (0, 3, 4) else (7, 5), fontsize=10, color=BLUE if central else ORANGE)
    axes.plot(3.25, 3.35, "k*", markersize=11)
    axes.annotate("sample behind the face 3 5 6:\nl0 < 0, so u7 = l0 / b, t0 = 0", (3.25, 3.35),
                  textcoords="offset points", xytext=(26, -52), fontsize=9,
                  arrowprops={"arrowstyle": "->"})
    axes.set_title("a cell: weights of its eight vertices", fontsize=11)
    axes.set_xlim(-0.4, 7.2)
    axes.set_ylim(-0.5, 4.8)


def draw_rows(axes):
    """Rows of even and odd vertices, and the cells that lie in the lanes."""
    for x in range(9):
        color = BLUE if x % 2 == 0 else ORANGE
        for y in (0, 1):
            axes.plot(x, 3.4 + y, "o", color=color, markersize=6)
    for cell in range(8):
        lane = cell % 2 == 0
        axes.add_patch(plt.Rectangle((cell + 0.06, 3.46), 0.88, 0.88, fill=lane, alpha=0.25 if lane else 1,
                                     facecolor=GREY, edgecolor=GREY, linewidth=0.8))
        if lane:
            axes.text(cell + 0.5, 3.9, f"lane {cell // 2}", ha="center", va="center", fontsize=8)
    axes.text(-0.2, 4.75, "a row of cells: every second one is a lane", fontsize=10)
    for row, (name, color, first) in enumerate((("even", BLUE, 0), ("odd", ORANGE, 1))):
        for k in range(4):
            x, y = 1.4 * k + 1.2, 1.6 - 1.0 * row
            axes.add_patch(plt.Rectangle((x, y), 1.3, 0.7, facecolor=color, alpha=0.25, edgecolor=color))
            axes.text(x + 0.65, y + 0.35, f"x = {2 * k + first}", ha="center", va="center", fontsize=9)
        axes.text(0.0, 1.95 - 1.0 * row, name, fontsize=10, color=color, va="center")
    axes.text(7.0, 1.45, "one load each\nfills all lanes", fontsize=9, va="center")
    axes.text(-0.2, 2.75, "the same vertices in local memory", fontsize=10)
    axes.set_title("a row of a brick", fontsize=11)
    axes.set_xlim(-0.5, 9.2)
    axes.set_ylim(0.2, 5.1)


figure, (left, right) = plt.subplots(1, 2, figsize=(11, 4), width_ratios=(1, 1.15))
for some in (left, right):
    some.set_axis_off()
draw_cell(left)
draw_rows(right)
figure.tight_layout()
figure.savefig(pathlib.Path(__file__).with_name("resampling.png"), dpi=110)
