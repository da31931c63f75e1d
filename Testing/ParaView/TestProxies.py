# SPDX-License-Identifier: BSD-3-Clause
"""Tests that every algorithm of the module has a proxy, that every method that sets, adds, returns or does something
has a property, and that the ranges and enumerations in the XML are those of the class. TestProperties.py tests
defaults, and sets the properties."""

import inspect
import re
import sys

import deformvolume_vtk
from vtkmodules.vtkCommonExecutionModel import vtkAlgorithm

from PluginTesting import plugin_proxies

# Methods that need no property: those that set data instead of a connection, those that properties
# of lists replace, those that access elements of lists, and those that need a number which an earlier call has returned.
WITHOUT_PROPERTY = {
    "SetDeformationData",
    "SetRestData",
    "SetReferenceData",
    "SetSheetData",
    "SetSurfaceData",
    "GetNumberOfToolPositions",
    "ClearToolPositions",
    "RemoveCategoricalArray",
    "GetNumberOfCategoricalArrays",
    "GetCategoricalArray",
    "RemoveDensityArray",
    "GetNumberOfDensityArrays",
    "GetDensityArray",
    "GetNumberOfLabels",
    "GetLabel",
    "GetNumberOfRefinementSpheres",
    "GetRefinementSphere",
    "GetDeviceNames",
    "SetHandlesData",
    "SetVolumeData",
    "GetMaterialLimits",
    "GetMaterialValues",
    "GetNumberOfMaterials",
    "GetNumberOfMaterialRanges",
    "GetNumberOfMaterialPresets",
    # The methods that access the table of presets.
    "GetMaterialPresetName",
    "GetMaterialPresetSource",
    "GetMaterialPresetValues",
    "SaveState",
    "RestoreState",
    "RemoveState",
    "GetNumberOfStates",
    "GetStateMemory",
    # ParaView reads each output immediately, for the ranges of its arrays.
    "SetOutputOnDevice",
    # A warning of the update states this number.
    "GetNumberOfOutsidePoints",
    # The property calls SetFromState() instead.
    "SetResampler",
}
# Proxies that Carve Volume and Finite Element Deformation replace. They are not in the menu, and exist for state files
# and scripts.
FORMER_PROXIES = {"CarveVolumeLabel", "CarveVolumeWithSurface", "CorotationalDeformation"}
# The largest number of widgets of a panel, without advanced ones.
MOST_WIDGETS = 8
# Numbers of removed enumerators.
REMOVED_VALUES = {"PieceMode": {1}, "Resampler": {1}}

failures = []


def check(condition, text):
    if not condition:
        failures.append(text)


def proxies_by_class():
    result = {}
    for proxy in plugin_proxies():
        result.setdefault(proxy.get("class"), []).append(proxy)
    return result


def properties_of(proxy):
    return [child for child in proxy if child.tag.endswith("Property")]


def own_names(cls):
    """Returns the names of members that the class and its bases in this package add to those of VTK's base class."""
    own = [base for base in cls.__mro__ if base in vars(deformvolume_vtk).values()]
    inherited = set(dir(own[-1].__bases__[0]))
    return {name for base in own for name in vars(base)} - inherited


def own_methods(cls):
    methods = [name for name in own_names(cls) if callable(getattr(cls, name))]
    setters = {name[3:] for name in methods if name.startswith("Set")}

    def redundant(name):
        return (
            re.match(r"Set\w+To[A-Z]", name)
            or re.fullmatch(r"Get\w+(Min|Max)Value", name)
            or re.sub("(On|Off)$", "", name) in setters
            or (name.startswith("Get") and name[3:] in setters)
        )

    return sorted(
        name
        for name in methods
        if not inspect.isclass(getattr(cls, name)) and not redundant(name)
    )


def check_complete(cls, proxies):
    commands = set()
    for proxy in proxies:
        for prop in properties_of(proxy):
            name, command = prop.get("name"), prop.get("command")
            commands.update((command, prop.get("clean_command")))
            if prop.tag == "Property":
                # A button sets no value that could be checked, so its name must be that of its method.
                check(name == command, f"{proxy.get('name')}.{name}: the button does {command}")
    for name in own_methods(cls):
        if name not in WITHOUT_PROPERTY:
            check(name in commands, f"{cls.__name__}.{name} has no property")
    for command in commands - {None}:
        check(hasattr(cls, command), f"{cls.__name__} has no method {command}")


def check_words(proxy):
    name = proxy.get("name")
    documentation = proxy.find("Documentation")
    check(documentation is not None, f"{name}: no documentation")
    for attribute in ("short_help", "long_help"):
        check(documentation.get(attribute), f"{name}: no {attribute}")
    check((documentation.text or "").strip(), f"{name}: no description")
    menu = proxy.find("Hints/ShowInMenu")
    if name in FORMER_PROXIES:
        check(menu is None, f"{name}: a former proxy is in the menu")
    else:
        right = menu is not None and menu.get("category") == "Deform Volume"
        check(right, f"{name}: not in the menu")
    grouped = [entry.get("name") for entry in proxy.findall("PropertyGroup/Property")]
    names = [prop.get("name") for prop in properties_of(proxy)]
    check(len(set(grouped)) == len(grouped), f"{name}: a property in two groups")
    check(set(grouped) <= set(names), f"{name}: groups contain unknown {set(grouped) - set(names)}")
    for prop in properties_of(proxy):
        text = prop.find("Documentation")
        label = f"{name}.{prop.get('name')}"
        if prop.get("repeat_command") and prop.tag != "StringVectorProperty":
            columns = int(prop.get("number_of_elements_per_command"))
            labels = prop.findall("Hints/ShowComponentLabels/ComponentLabel")
            check(prop.find("Hints/ShowLabel") is not None, f"{label}: the table has no title")
            check(len(labels) == columns or columns == 1, f"{label}: the table has no names of columns")
        check(text is not None and text.text.strip(), f"{label}: no documentation")
        for decorator in prop.iter("PropertyWidgetDecorator"):
            other = decorator.get("property")
            check(other is None or other in names, f"{label}: decorated by the unknown {other}")
        for required in prop.iter("RequiredProperties"):
            for entry in required:
                check(entry.get("name") in names, f"{label}: requires the unknown {entry.get('name')}")


def is_enabled(prop, settings):
    """Whether the panel enables a property, by its decorators. settings: the values of the others, as texts."""

    def evaluate(element):
        if element.get("type") == "CompositeDecorator":
            expression = element.find("Expression")
            parts = [evaluate(part) for part in expression]
            return any(parts) if expression.get("type") == "or" else all(parts)
        if element.get("mode") != "enabled_state":
            return True
        is_equal = settings[element.get("property")] == element.get("value")
        return is_equal != (element.get("inverse") == "1")

    return all(evaluate(decorator) for decorator in prop.findall("Hints/PropertyWidgetDecorator"))


def check_outside_mode(proxies):
    """Mesh Rasterization has outside modes with inverse fields only."""
    for proxy in proxies:
        for prop in properties_of(proxy):
            if prop.get("name") == "OutsideMode":
                for resampler, inverse in ((resampler, inverse) for resampler in "02" for inverse in "01"):
                    enabled = is_enabled(prop, {"Resampler": resampler, "FieldIsInverse": inverse})
                    check(
                        enabled == (resampler != "2" or inverse == "1"),
                        f"{proxy.get('name')}.OutsideMode: enabled is {enabled} with the resampler {resampler} and "
                        f"FieldIsInverse {inverse}",
                    )


def is_set_by_user(prop):
    """Whether a user sets the property. False for information, buttons, inputs that are connected in the pipeline, and
    removed properties."""
    is_connected = prop.tag == "InputProperty" and prop.find("ProxyListDomain") is None
    return not (
        is_connected
        or prop.tag == "Property"
        or prop.get("information_only")
        or prop.get("panel_visibility") == "never"
    )


def is_widget(prop):
    """Whether the default panel shows the property. It shows information properties only if the XML says so."""
    if prop.tag == "InputProperty" and prop.find("ProxyListDomain") is None:
        return False
    default = "never" if prop.get("information_only") else "default"
    return prop.get("panel_visibility", default) == "default"


def check_panel(proxy):
    name = proxy.get("name")
    widgets = [prop.get("name") for prop in properties_of(proxy) if is_widget(prop)]
    too_many = f"{name}: {len(widgets)} widgets. Make some of them advanced: {widgets}"
    check(len(widgets) <= MOST_WIDGETS, too_many)
    for prop in properties_of(proxy):
        label = f"{name}.{prop.get('name')}"
        if is_set_by_user(prop):
            text = " ".join(prop.find("Documentation").text.split())
            check("Default: " in text, f"{label}: the documentation does not say the default")
        if re.search("Arrays?(Name)?$", prop.get("name")):
            check(prop.find("ArrayListDomain") is not None, f"{label}: no ArrayListDomain")


def check_values(cls, proxy):
    instance = cls()
    for prop in properties_of(proxy):
        command, label = prop.get("command", ""), f"{proxy.get('name')}.{prop.get('name')}"
        attribute = prop.get("initial_string") or command[3:]
        if not command.startswith("Set") or "Get" + attribute not in own_names(cls):
            continue
        if prop.tag == "ProxyProperty":
            continue  # an object: the default is the first proxy in the list of its domain
        if prop.get("repeat_command"):
            continue  # a list, whose getter needs an index
        value = getattr(instance, "Get" + attribute)()
        if hasattr(instance, f"Get{attribute}MaxValue"):
            low = getattr(instance, f"Get{attribute}MinValue")()
            high = getattr(instance, f"Get{attribute}MaxValue")()
            entries = {int(entry.get("value")): entry.get("text") for entry in prop.iter("Entry")}
            if entries:
                numbers = set(range(low, high + 1)) - REMOVED_VALUES.get(attribute, set())
                check(set(entries) == numbers, f"{label}: the entries are {entries}, but the class has {numbers}")
                for number, text in entries.items():
                    setter = f"Set{attribute}To{re.sub('[ -]', '', text)}"
                    setter = setter if hasattr(instance, setter) else setter + attribute
                    if not hasattr(instance, setter):
                        check(False, f"{label}: no {setter}")
                        continue
                    getattr(instance, setter)()
                    got = getattr(instance, "Get" + attribute)()
                    check(got == number, f"{label}: {text} is {got}, not {number}")
            else:
                ranges = [child for child in prop if child.tag.endswith("RangeDomain")]
                check(len(ranges) == 1, f"{label}: expected one range domain, not {len(ranges)}")
                check(float(ranges[0].get("min")) == low, f"{label}: min of the range is not {low}, that of the class")
                if high < 2**31:
                    check(
                        float(ranges[0].get("max")) == high,
                        f"{label}: max of the range is not {high}, that of the class",
                    )
        elif isinstance(value, bool):
            check(
                prop.find("BooleanDomain") is not None,
                f"{label}: the class has a bool, but there is no BooleanDomain",
            )


def main():
    proxies = proxies_by_class()
    classes = {
        name: value
        for name, value in vars(deformvolume_vtk).items()
        if inspect.isclass(value) and issubclass(value, vtkAlgorithm) and not value.__subclasses__()
    }
    check(len(classes) >= 3, f"The package has only {sorted(classes)}")
    for name, cls in sorted(classes.items()):
        check(name in proxies, f"{name} has no proxy in Plugin")
        if name not in proxies:
            continue
        check_complete(cls, proxies[name])
        for proxy in proxies[name]:
            check_words(proxy)
            check_panel(proxy)
            check_values(cls, proxy)
    check_outside_mode(proxies["vtkDeformVolumeFilter"])
    for failure in failures:
        print(failure)
    return 1 if failures else 0


sys.exit(main())
