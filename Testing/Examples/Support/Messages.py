# SPDX-License-Identifier: BSD-3-Clause
"""Checks the wording of messages of a program."""
import os
import re

from Volumes import call

# Words that only programmers know: classes, methods, addresses, enumerators and VTK's pipeline. Users know the array
# names vtkGhostType and vtkValidPointMask.
CODE = re.compile(r"\bvtk(?!GhostType|ValidPointMask)[A-Z]\w*|::|\b[A-Za-z]\w*\(\)|\b0x[0-9a-f]{4}|"
                  r"\b[A-Z]{4,}_[A-Z]+\b|\b[A-Z][a-z]+[A-Z][a-z]\w*|input port|\b[Cc]onnect\b|"
                  r"\bREQUEST\b")
NAMES = ("TetGen", "ParaView", "ChainMail", "Mach", "MetaImage", "OpenCL", "DEFORMVOLUME_TETGEN",
         "TMPDIR", "STLReader", "NumberOfCells", "NREG_TRANS", "NiftyReg")


def check_words(text):
    """Checks that a text has no such words, apart from names of programs and paths of files."""
    words = re.sub("|".join(NAMES) + r"|\S*/\S*", "", text)
    assert not CODE.search(words), f"{CODE.search(words).group()} in {text}"


def fails(program, code, expected, *arguments, warnings=0, environment=None):
    """Calls a program, which has to fail with a message of one line. expected: texts in this line."""
    output, errors = call(program, *arguments, code=code, quiet=True, environment=environment)
    print("  ", errors.strip())
    assert output == "", output
    assert errors.splitlines()[-1].startswith("deform-volume: "), errors
    assert errors.count("\n") == 1 + warnings, errors
    assert "no reason was reported" not in errors, errors
    for text in [expected] if isinstance(expected, str) else expected:
        assert text in errors, f"{text} is not in {errors}"
    check_words(errors)


def refuses(program, path, code, expected, *arguments, source="in.vti", warnings=0):
    """Calls a program with a volume. It has to fail, and must not write an output."""
    fails(program, code, expected, path(source), *arguments, "-o", path("o.vti"), warnings=warnings)
    assert not os.path.exists(path("o.vti"))


def warns(program, expected, *arguments):
    """Calls a program, which has to succeed with a warning."""
    _, errors = call(program, *arguments, "--quiet")
    assert errors.startswith("deform-volume: warning: "), errors
    for text in [expected] if isinstance(expected, str) else expected:
        assert text in errors, f"{text} is not in {errors}"
    check_words(errors)
