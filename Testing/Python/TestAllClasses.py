# SPDX-License-Identifier: BSD-3-Clause
"""Creates and prints every class of the package, sets and reads its properties, updates it without input,
and checks that headers follow VTK's rules. Lists all failures at the end."""

import inspect
import os
import re
import sys

import deformvolume_vtk
from vtkmodules.vtkCommonCore import vtkObject
from vtkmodules.vtkCommonDataModel import (
    vtkImageData,
    vtkMultiBlockDataSet,
    vtkPolyData,
    vtkUnstructuredGrid,
)
from vtkmodules.vtkCommonExecutionModel import vtkAlgorithm

FOLDERS = ["Filters"]
if hasattr(deformvolume_vtk, "vtkDeformVolumeSession"):  # missing with ParaView's VTK
    FOLDERS.append("Interaction")
ROOT = os.path.join(os.path.dirname(__file__), "..", "..")

failures = []


def check(condition, text):
    if not condition:
        failures.append(text)


def own_classes():
    classes = [
        value
        for value in vars(deformvolume_vtk).values()
        if inspect.isclass(value) and issubclass(value, vtkObject)
    ]
    return sorted(classes, key=lambda value: value.__name__)


def is_abstract(cls):
    return bool(cls.__subclasses__())


def own_names(cls):
    """Returns the names of members that the class and its bases in this package declare."""
    return sorted({name for base in cls.__mro__ if base in own_classes() for name in vars(base)})


def properties(cls):
    """Returns the names of properties: those with a setter and a getter without arguments in this package."""
    for name in own_names(cls):
        if name.startswith("Set") and hasattr(cls, "Get" + name[3:]):
            yield name[3:]


def other_values(value):
    """Returns other values of the same type, which are set one after the other."""
    if isinstance(value, bool):
        return [not value]
    if isinstance(value, int):
        return [value + 1, max(value - 1, 0)]
    if isinstance(value, float):
        return [2.0 * value + 0.5, value + 0.25]
    if isinstance(value, str):
        return [value + "other"]
    if isinstance(value, tuple):
        return [tuple(other_values(item)[0] for item in value)]
    return None


# Numbers of removed enumerators, which set another value with a warning, and numbers that are errors.
REFUSED_VALUES = {"vtkTetGenMesher.PieceMode": 1, "vtkDeformVolumeSession.MovingSamplingFactor": 0}


def check_properties(cls):
    instance = cls()
    count = 0
    for name in properties(cls):
        get, set_ = getattr(instance, "Get" + name), getattr(instance, "Set" + name)
        label = f"{cls.__name__}.{name}"
        try:
            value = get()
        except TypeError:
            continue  # not a property: the getter takes arguments
        if value is None or isinstance(value, vtkObject):
            set_(None)
            check(get() is None, f"{label}: None is not kept")
            count += 1
            continue
        others = other_values(value)
        check(others is not None, f"{label}: other_values() has no values of type {type(value)}")
        for other in others or []:
            if other == REFUSED_VALUES.get(label):
                continue
            before = instance.GetMTime()
            set_(*other) if isinstance(other, tuple) and len(other) > 1 else set_(other)
            got = get()
            clamped = hasattr(cls, f"Get{name}MaxValue")
            if clamped:
                low, high = getattr(instance, f"Get{name}MinValue")(), getattr(
                    instance, f"Get{name}MaxValue"
                )()
                other = min(max(other, low), high)
            check(got == other, f"{label}: {other} was set, {got} is read")
            if other != value:
                check(instance.GetMTime() > before, f"{label}: setting {other} does not change the MTime")
            before = instance.GetMTime()
            set_(*other) if isinstance(other, tuple) and len(other) > 1 else set_(other)
            check(instance.GetMTime() == before, f"{label}: setting {other} again changes the MTime")
            value = got
        if hasattr(cls, f"Get{name}MaxValue"):
            low = getattr(instance, f"Get{name}MinValue")()
            high = getattr(instance, f"Get{name}MaxValue")()
            set_(high)
            check(get() == high, f"{label}: the greatest value {high} is not kept")
            if isinstance(low, int) and low > -(2**31):
                set_(low - 1)
                check(get() == low, f"{label}: {low - 1} is not clamped to {low}")
        for mode in [key for key in dir(cls) if re.fullmatch(f"Set{name}To[A-Z].*", key)]:
            getattr(instance, mode)()
            enumerator = re.sub(r"(?<=[a-z])(?=[A-Z])", "_", mode.split(name + "To")[1]).upper()
            check(hasattr(cls, enumerator), f"{label}: there is no {enumerator} for {mode}")
            check(
                get() == getattr(cls, enumerator, None),
                f"{cls.__name__}.{mode} gives {get()}",
            )
        for mode in ("On", "Off"):
            if hasattr(instance, name + mode):
                getattr(instance, name + mode)()
                check(bool(get()) == (mode == "On"), f"{label}{mode} gives {get()}")
        check(name in str(instance), f"{label}: PrintSelf does not print it")
        count += 1
    return count


class Messages:
    """Counts the messages of an algorithm and of its executive instead of printing them."""

    def __init__(self, algorithm):
        self.errors = []
        for source in (algorithm, algorithm.GetExecutive()):
            self.observe(source)

    def observe(self, source):
        def error(_caller, _event, text):
            self.errors.append(text)

        error.CallDataType = "string0"
        source.AddObserver("ErrorEvent", error)
        source.AddObserver("WarningEvent", lambda *_: None)


def check_empty_input(cls):
    def run(label, prepare):
        instance = cls()
        messages = Messages(instance)
        prepare(instance)
        for _ in range(2):
            instance.Modified()
            instance.Update()
        for port in range(instance.GetNumberOfOutputPorts()):
            output = instance.GetOutputDataObject(port)
            check(output is not None, f"{cls.__name__} with {label}: port {port} has no output")
            if instance.GetNumberOfInputPorts() and messages.errors:
                check(
                    output.GetNumberOfElements(0) == 0 or not output.GetPointData().GetNumberOfArrays(),
                    f"{cls.__name__} with {label}: there is an error, but port {port} has data",
                )
        return messages.errors

    run("no input", lambda instance: None)
    ports = cls().GetNumberOfInputPorts()
    for data in (vtkImageData, vtkUnstructuredGrid, vtkPolyData, vtkMultiBlockDataSet):
        def all_ports(instance):
            for port in range(ports):
                instance.SetInputDataObject(port, data())

        run(f"empty {data.__name__}", all_ports)


def check_header(name):
    path = next(
        path
        for path in (os.path.join(ROOT, folder, name + ".h") for folder in FOLDERS)
        if os.path.exists(path)
    )
    with open(path, encoding="ascii") as file:
        header = file.read()
    for pattern, what in (
        (rf"vtk(Abstract)?TypeMacro\({name}, \w+\);", "vtkTypeMacro"),
        (r"void PrintSelf\(ostream& \w+, vtkIndent \w+\) override;", "PrintSelf"),
        (rf"{name}\(const {name}&\) = delete;", "a deleted copy constructor"),
        (rf"void operator=\(const {name}&\) = delete;", "a deleted assignment"),
        (rf"@class\s+{name}", "@class"),
        (r"@brief", "@brief"),
        (rf"#ifndef {name}_h\s+#define {name}_h", "a guard"),
    ):
        check(re.search(pattern, header), f"{name}.h: {what} is missing")
    check(header.startswith("// SPDX-License-Identifier: "), f"{name}.h: the first line is not a license")


def check_docstrings(cls):
    """Setters and actions need a comment of their own: VTK's wrapper gives that of a group to its first member."""
    for name, method in vars(cls).items():
        if inspect.isroutine(method) and not re.match("_|Get|On[A-Z]|.*O(n|ff)$|Set.*To[A-Z]|SafeDown|NewInst", name):
            check("\n\n" in method.__doc__.strip(), f"{cls.__name__}.{name}: help() has no text")


def check_abstract(cls):
    try:
        cls()
    except (NotImplementedError, TypeError):
        return
    check(False, f"{cls.__name__}: an abstract class that can be instantiated")


def main():
    classes = own_classes()
    headers = sorted(
        name[:-2]
        for folder in FOLDERS
        for name in os.listdir(os.path.join(ROOT, folder))
        if re.fullmatch(r"vtk\w+\.h", name) and not name.endswith("Internals.h")
    )
    names = [cls.__name__ for cls in classes]
    check(names == headers, f"The package has the classes {names}, but the folders {FOLDERS} have {headers}")
    for cls in classes:
        check_header(cls.__name__)
        check_docstrings(cls)
        if is_abstract(cls):
            check_abstract(cls)
            continue
        instance = cls()
        check(instance.GetClassName() == cls.__name__, f"{cls.__name__}: its name is wrong")
        check(instance.NewInstance().IsA(cls.__name__), f"{cls.__name__}: NewInstance is wrong")
        check(str(instance), f"{cls.__name__}: prints nothing")
        count = check_properties(cls)
        check(count > 0, f"{cls.__name__}: no property found")
        if issubclass(cls, vtkAlgorithm):
            check_empty_input(cls)
        print(f"{cls.__name__}: {count} properties")
    for failure in failures:
        print(failure)
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
