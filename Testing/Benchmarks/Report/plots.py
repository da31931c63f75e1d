# SPDX-License-Identifier: BSD-3-Clause
"""Draws the plots of the report."""
import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402  (after the choice of the backend)
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter  # noqa: E402

STYLES = {
    "exact": ("Exact", "tab:blue", "o"),
    "mesh-rasterization": ("MeshRasterization", "tab:green", "s"),
}


class Pictures:
    """The folder of the plots, and its path in the text that shows them."""

    def __init__(self, folder, prefix=""):
        self.folder = folder
        self.prefix = prefix

    def show(self, name, words):
        """Returns the Markdown that shows a plot."""
        return f"![{words}]({self.prefix}{name})\n"


def _finish(axes, path, title):
    axes.figure.suptitle(title, fontsize=10)
    axes.grid(True, which="both", alpha=0.25)
    axes.figure.tight_layout()
    axes.figure.savefig(path, dpi=110)
    plt.close(axes.figure)


def _label_plainly(axis, ticks=(1.0, 2.0, 5.0)):
    """Labels the ticks of a logarithmic axis with plain numbers."""
    axis.set_major_locator(LogLocator(subs=ticks))
    axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:,.10g}"))
    axis.set_minor_formatter(NullFormatter())


def plot_curves(path, title, labels, curves, band=None):
    """Draws curves. curves: resampler -> (x, y). band: (lower, upper) of y."""
    _, axes = plt.subplots(figsize=(7, 4.2))
    for resampler, (x, y) in curves.items():
        label, color, marker = STYLES[resampler]
        axes.plot(x, y, marker=marker, color=color, label=label)
    if band:
        axes.axhspan(*band, color="tab:blue", alpha=0.12, label="Exact, ±20 %")
    axes.set_xscale("log")
    axes.set_yscale("log")
    _label_plainly(axes.yaxis)
    axes.set_xlabel(labels[0])
    axes.set_ylabel(labels[1])
    axes.legend()
    _finish(axes, path, title)


def plot_bars(path, title, label, bars):
    """Draws horizontal bars. bars: (name, value, whether it is DeformVolume)."""
    _, axes = plt.subplots(figsize=(9, 0.36 * len(bars) + 1.3))
    names = [name for name, _, _ in bars]
    values = [value for _, value, _ in bars]
    colors = ["tab:blue" if ours else "tab:gray" for _, _, ours in bars]
    drawn = axes.barh(names, values, color=colors)
    axes.bar_label(drawn, [f"{value:.0f}" if value >= 10.0 else f"{value:.3g}" for value in values],
                   padding=3, fontsize=8)
    axes.invert_yaxis()
    axes.set_xscale("log")
    _label_plainly(axes.xaxis, (1.0, 2.0, 5.0) if max(values) < 30.0 * min(values) else (1.0,))
    axes.set_xlim(0.3 * min(values), 4.0 * max(values))
    axes.set_xlabel(label)
    _finish(axes, path, title)
