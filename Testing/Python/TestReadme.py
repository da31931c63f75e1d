# SPDX-License-Identifier: BSD-3-Clause
"""The lines of Python in README.md, as they stand there: TestReadme.py README"""
import re
import sys

text = open(sys.argv[1], encoding="utf-8").read()
blocks = re.findall(r"^```python\n(.*?)^```$", text, re.MULTILINE | re.DOTALL)
assert len(blocks) == 1, len(blocks)
names = {}
exec(compile(blocks[0], sys.argv[1], "exec"), names)  # pylint: disable=exec-used
rest = names["volume"].GetOutput()
result = names["result"]
# Bent to one side by up to 5 voxels at both ends: 21 voxels on each axis become 26 or 27 on x.
assert rest.GetDimensions() == (21, 21, 21)
low, high = result.GetBounds()[:2]
assert (low, high) == (-10, 15), (low, high)
assert names["deform"].GetNumberOfCoveredVoxels() > 0.95 * 21 ** 3
assert names["deform"].GetNumberOfInvertedTetrahedra() == 0
