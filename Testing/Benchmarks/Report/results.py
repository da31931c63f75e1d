# SPDX-License-Identifier: BSD-3-Clause
"""Reads the results of the benchmark programs for one device."""
import collections
import datetime
import json
import pathlib
import statistics

# Google Benchmark appends this to names.
SUFFIX = "/iterations:"


def format_date(text):
    """Returns a date of Google Benchmark in the form 27 November 2026."""
    day = datetime.datetime.fromisoformat(text)
    return f"{day.day} {day:%B %Y}"


class Results:
    """The measurements of all JSON files in a folder, by name, in the order of the rounds."""

    def __init__(self, folder):
        self.runs = collections.defaultdict(list)
        self.context = {}
        self.unreadable = []
        for path in sorted(pathlib.Path(folder).glob("*.json")):
            try:
                with open(path, encoding="utf-8") as file:
                    result = json.load(file)
            except json.JSONDecodeError as error:
                self.unreadable.append((path.name, f"it is empty or cut off: {error}"))
                continue
            self.context.update(result["context"])
            for run in result["benchmarks"]:
                self.runs[run["name"].split(SUFFIX)[0]].append(run)

    @property
    def device(self):
        """The name of the device, as DeformVolumeDevice has written it."""
        return self.context.get("device", "a device that was not described")

    @property
    def is_processor(self):
        return self.context.get("device_is_processor") == "1"

    @property
    def processors(self):
        """The description of the CPUs, as machine.py has written it."""
        return self.context.get("processors", "unknown processors")

    def names(self, prefix):
        """Names that begin with a prefix, in the order of their first run."""
        return [name for name in self.runs if name.startswith(prefix)]

    def errors(self):
        """(name, message) of each failed measurement, and of each file that cannot be read."""
        return self.unreadable + [(name, runs[0]["error_message"]) for name, runs in self.runs.items()
                                  if runs[0].get("error_occurred")]

    def values(self, name, key="real_time"):
        """One value for each round; None for a failed one."""
        return [None if run.get("error_occurred") else run.get(key)
                for run in self.runs.get(name, [])]

    def median(self, name, key="real_time"):
        """Median over the rounds; None if there is no value."""
        values = [value for value in self.values(name, key) if value is not None]
        return statistics.median(values) if values else None

    def milliseconds(self, name, key):
        """Median over the rounds of a counter that is in seconds."""
        seconds = self.median(name, key)
        return None if seconds is None else 1e3 * seconds

    def difference(self, name, other, key="real_time"):
        """Median of the differences of name to other within each round."""
        pairs = zip(self.values(name, key), self.values(other, key))
        differences = [a - b for a, b in pairs if a is not None and b is not None]
        return statistics.median(differences) if differences else None

    def ratio(self, name, other, key="real_time"):
        """Median of the ratios of name to other within each round."""
        pairs = zip(self.values(name, key), self.values(other, key))
        ratios = [a / b for a, b in pairs if a is not None and b]
        return statistics.median(ratios) if ratios else None
