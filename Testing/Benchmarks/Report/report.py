# SPDX-License-Identifier: BSD-3-Clause
"""Makes a report in Markdown, with plots, of the results of the benchmark programs: report.py FOLDER [DOCUMENT].
FOLDER contains a folder of JSON files for each device; report.md and the plots are written to FOLDER. With
DOCUMENT the report is about GPUs only and is written to that file, between the lines BEGIN and END, so that text before
and after them is kept; its plots are written to images/ beside it."""
import pathlib
import sys

import sections
from plots import Pictures
from results import Results, format_date
from sections import table

BEGIN = "<!-- Written by Testing/Benchmarks/Report/report.py: -->\n"
END = "<!-- End of the written text -->\n"


def describe(results):
    context = results.context
    words = [results.device] + [f"{word} {context[key]}".strip() for word, key in (
        ("driver", "driver"), ("", "version")) if key in context]
    if "compute_units" in context:
        words.append(f"{context['compute_units']} compute units")
    if results.is_processor:
        words.append(f"vectors of {context['vector_width']} floats")
    return ", ".join(words) + f"; host {results.processors}"


def device_report(results, pictures, kind):
    yield f"# Device {kind}: {results.device}\n"
    missing = []
    for words, section in (sections.ALL if results.is_processor else sections.ON_GPUS | sections.ALL).items():
        lines = list(section(results, pictures, kind))
        yield from lines
        if not lines:
            missing.append(words)
    if missing:
        yield f"Not measured: {', '.join(missing)}.\n"
    errors = results.errors()
    if errors:
        yield "## Failed measurements\n"
        yield table(["measurement", "message"],
                    [[name, " ".join(words.split())] for name, words in errors])


def report(devices, pictures, title, manual):
    """Yields the report. title: None for no title. manual: the link to Documents/benchmarks.md."""
    if title:
        yield f"# {title}\n"
    date = min(results.context["date"] for results in devices.values())
    yield f"Measured on {format_date(date)}. {manual} describes the tables.\n"
    yield table(["device", "description"],
                [[kind, describe(results)] for kind, results in devices.items()])
    yield ("The numbers are medians over the rounds of one run; ratios are medians of ratios within "
           "rounds.\n")
    for kind, results in devices.items():
        yield from device_report(results, pictures, kind)


def main(folder, document=None):
    if not folder.is_dir():
        sys.exit(f"report.py: {folder} is not a folder")
    devices = {path.name: Results(path) for path in sorted(folder.iterdir()) if path.is_dir()}
    devices = {kind: results for kind, results in devices.items()
               if results.runs and not (document and results.is_processor)}
    if not devices:
        sys.exit(f"report.py: {folder} contains no results" + (" of a GPU" if document else ""))
    if document:
        pictures = Pictures(document.parent / "images", "images/")
        pictures.folder.mkdir(exist_ok=True)
        title, manual = None, "[benchmarks.md](benchmarks.md)"
        old = document.read_text(encoding="utf-8") if document.exists() else "# Benchmarks on GPUs\n\n" + BEGIN + END
        if old.count(BEGIN) != 1 or END not in old.split(BEGIN)[1]:
            sys.exit(f"report.py: {document} has no lines {BEGIN.strip()} and {END.strip()}, between which to write")
        before, after = old.split(BEGIN)
        before, after = before + BEGIN, END + after.split(END, 1)[1]
    else:
        document = folder / "report.md"
        pictures = Pictures(folder)
        title, manual = "Benchmarks", "Documents/benchmarks.md"
        before = after = ""
    text = before + "\n".join(report(devices, pictures, title, manual)) + after
    document.write_text(text, encoding="utf-8")
    print(text)


if __name__ == "__main__":
    if len(sys.argv) not in (2, 3):
        sys.exit(__doc__)
    main(*map(pathlib.Path, sys.argv[1:]))
