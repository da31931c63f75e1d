# SPDX-License-Identifier: BSD-3-Clause
"""Tests every property of every proxy: its default is that of the class, and setting it changes that property of the
proxy's object and no other. Then each property is set to its extremes: the process does not end, an error is one
readable message, and the defaults work afterwards. At the end, tests the values that ParaView's panels show."""

import re

import deformvolume_vtk  # noqa: F401, the classes of the objects on the server
from paraview import simple
from vtkmodules.vtkCommonDataModel import vtkDataObject
from vtkmodules.vtkCommonExecutionModel import vtkAlgorithm, vtkTrivialProducer

from PluginTesting import (
    bent_lattice,
    check,
    check_silent,
    deformed,
    load_plugin,
    messages,
    plugin_proxies,
    wavelet,
)

# Properties with another default in ParaView than in the class. ParaView's animation always has a time, so simulations
# have an end time. A panel shows the name of a device. Views hide cells that are cut.
OTHER_DEFAULTS = {
    ("vtkMassSpringDeformation", "EndTime"): [1.0],
    ("vtkFiniteElementDeformation", "EndTime"): [1.0],
    ("vtkDeformVolumeFilter", "Device"): ["best"],
    ("vtkCutVolume", "BlankCells"): [True],
    ("vtkCarveVolume", "BlankCells"): [True],
}
# Removed properties of former versions. TestOldFiles.py sets them.
REMOVED = {"StreamInput", "WorkGroupSize", "NumberOfTimeSamples"}
# Properties that the filters of main() are made with.
SET_BY_TEST = {"AutomaticIsovalue", "Isovalue", "Labels", "MemoryLimit", "TargetEdgeLength", "ToolPositions"}
# Valid values of lists. All other lists accept any numbers.
LISTS = {
    ("vtkChainMailDeformation", "Materials"): [3, 0.5, 1.5, 0.25, 7, 0.25, 2.5, 0.125],
    ("vtkMaterialFromVolume", "Materials"): [3, 2000.5, 0.25, 900, 7, 500, 0.125, 1100],
    ("vtkMaterialFromVolume", "MaterialPresets"): [3, 7, 4, 2],
}


def read_materials(instance):
    """Returns the index and the values of each material that is defined."""
    read = getattr(instance, "GetMaterialLimits", None) or instance.GetMaterialValues
    result = []
    for index in range(256):
        values = [0.0] * 3
        if read(index, values):
            result += [index, *values]
    check(len(result) == 4 * instance.GetNumberOfMaterials(), "Not all materials are found")
    return result


def read_presets(instance):
    """Returns the index and the preset of each material that has one."""
    presets = [(index, instance.GetMaterialPreset(index)) for index in range(256)]
    found = [number for pair in presets if pair[1] for number in pair]
    check(len(found) == 2 * instance.GetNumberOfMaterialPresets(), f"{found} are presets")
    return found


def read_ranges(instance):
    """Returns the ranges of materials from the text that the class prints, because it has no getter."""
    printed = re.search(r"MaterialRanges:\n((?: +\S+ to \S+: \d+\n)*)", str(instance)).group(1)
    ranges = re.findall(r"(\S+) to (\S+): (\d+)", printed)
    check(len(ranges) == instance.GetNumberOfMaterialRanges(), f"{ranges} are printed")
    return [float(number) for entry in ranges for number in entry]


def read_spheres(instance):
    result = []
    for index in range(instance.GetNumberOfRefinementSpheres()):
        sphere = [0.0] * 5
        instance.GetRefinementSphere(index, sphere)
        result += sphere
    return result


def read_array_choice(instance):
    information = instance.GetInputArrayInformation(0)
    keys = (vtkAlgorithm.INPUT_PORT(), vtkAlgorithm.INPUT_CONNECTION(),
            vtkDataObject.FIELD_ASSOCIATION())
    name = information.Get(vtkDataObject.FIELD_NAME())
    return ["0", *(str(information.Get(key)) for key in keys), name or ""]


# Functions that read properties without a getter of the same name. For positions of tools, the classes have only a
# getter of their number. TestEdits.py tests where tools cut.
READERS = {
    "Materials": read_materials,
    "MaterialPresets": read_presets,
    "MaterialRanges": read_ranges,
    "RefinementSpheres": read_spheres,
    "Labels": lambda made: [made.GetLabel(i) for i in range(made.GetNumberOfLabels())],
    "CategoricalArrays": lambda made: [
        made.GetCategoricalArray(i) for i in range(made.GetNumberOfCategoricalArrays())
    ],
    "DensityArrays": lambda made: [
        made.GetDensityArray(i) for i in range(made.GetNumberOfDensityArrays())
    ],
    "ToolPositions": lambda made: made.GetNumberOfToolPositions(),
    "DisplacementArray": read_array_choice,
    "Scalars": read_array_choice,
}


def properties_of(proxy, information=False):
    """Returns the properties that a user sets, or the information properties, by name."""
    iterator = proxy.SMProxy.NewPropertyIterator()
    result = {}
    iterator.Begin()
    while not iterator.IsAtEnd():
        if (
            bool(iterator.GetProperty().GetInformationOnly()) == information
            and iterator.GetKey() not in REMOVED
        ):
            result[iterator.GetKey()] = iterator.GetProperty()
        iterator.Next()
    return result


def find_port(cls, name):
    """Returns the input port to which an input property must be connected."""
    instance, producer = cls(), vtkTrivialProducer()
    getattr(instance, f"Set{name}Connection")(producer.GetOutputPort())
    ports = range(instance.GetNumberOfInputPorts())
    return next(port for port in ports if instance.GetNumberOfInputConnections(port))


def read(instance, name, smproperty):
    """Returns the value that the object has for a property. Fails the test if it cannot be read."""
    if smproperty.IsA("vtkSMInputProperty"):
        port = find_port(type(instance), name)
        count = instance.GetNumberOfInputConnections(port)
        return [instance.GetInputConnection(port, i).GetProducer() for i in range(count)]
    if name in READERS:
        return READERS[name](instance)
    getter = getattr(instance, f"Get{name}", None)
    check(getter, f"{type(instance).__name__} has no Get{name}(): add it to READERS")
    value = getter()
    return list(value) if isinstance(value, tuple) else [value]


def elements_of(smproperty):
    return [smproperty.GetElement(i) for i in range(smproperty.GetNumberOfElements())]


def other_values(instance, name, smproperty, default):
    """Returns values other than the default, as lists of elements. No two numbers of a list are equal."""
    domain = smproperty.FindDomain("vtkSMEnumerationDomain")
    if domain:
        entries = [domain.GetEntryValue(i) for i in range(domain.GetNumberOfEntries())]
        return [[entry] for entry in entries if entry != default[0]]
    if smproperty.FindDomain("vtkSMBooleanDomain"):
        return [[1 - int(default[0])]]
    is_text = smproperty.IsA("vtkSMStringVectorProperty")
    if smproperty.GetRepeatable():
        if (type(instance).__name__, name) in LISTS:
            return [LISTS[type(instance).__name__, name]]
        numbers = range(1, 2 * smproperty.GetNumberOfElementsPerCommand() + 1)
        return [[f"array {number}" if is_text else number for number in numbers], []]
    if is_text:
        return [[*default[:-1], "another"]]
    # Some properties are integers in the class, and floating-point numbers in ParaView.
    step = 1 if isinstance(default[0], int) else 0.0625
    values = [number + step * (i + 1) for i, number in enumerate(default)]
    if smproperty.IsA("vtkSMIntVectorProperty") or smproperty.IsA("vtkSMDoubleVectorProperty"):
        greatest = getattr(instance, f"Get{name}MaxValue", lambda: values[0])()
        return [values if values[0] <= greatest else [default[0] - step]]
    return []


def set_elements(smproperty, values):
    smproperty.SetNumberOfElements(len(values))
    for i, value in enumerate(values):
        smproperty.SetElement(i, value)


def has(got, values, name, smproperty):
    """Whether the value that was read is the one that was set."""
    if name == "ToolPositions":
        return got == len(values) // smproperty.GetNumberOfElementsPerCommand()
    return got == values


def check_reach(proxy, sources):
    instance = proxy.GetClientSideObject()
    fresh = type(instance)()
    properties = {
        name: smproperty
        for name, smproperty in properties_of(proxy).items()
        # Leave out buttons, and inputs that only widgets use.
        if smproperty.GetClassName() != "vtkSMProperty" and smproperty.GetCommand()
    }

    def read_all():
        return {name: read(instance, name, prop) for name, prop in properties.items()}

    def check_only(name, before, is_right, label):
        """Checks that this property has changed, and no other one."""
        after = read_all()
        check(is_right(after[name]), f"{label}: the object has {after[name]}")
        others = [other for other in before if other != name and before[other] != after[other]]
        check(not others, f"{label} changes {others}")

    for name, smproperty in properties.items():
        label = f"{proxy.GetXMLName()}.{name}"
        before = read_all()
        if smproperty.FindDomain("vtkSMProxyListDomain") and smproperty.IsA("vtkSMInputProperty"):
            made = proxy.GetProperty(name).GetData().GetClientSideObject()
            check(comes_from(made)(before[name]), f"{label}: {before[name]}")
            continue
        if smproperty.IsA("vtkSMInputProperty"):
            check(not before[name], f"{label}: there is an input")
            check_input(proxy, name, smproperty, sources, check_only, before)
            continue
        if smproperty.IsA("vtkSMProxyProperty"):
            wrapped = proxy.GetProperty(name)
            check(len(wrapped.Available) > 1, f"{label}: no choice")
            for choice in reversed(wrapped.Available):
                wrapped.SetData(choice)
                proxy.SMProxy.UpdateVTKObjects()
                chosen = [wrapped.GetData().GetClientSideObject()]
                check_only(name, before, lambda got: got == chosen, f"{label} = {choice}")
            continue
        default = read(fresh, name, smproperty)
        default = OTHER_DEFAULTS.get((type(instance).__name__, name), default)
        check(before[name] == default, f"{label}: the default is {before[name]}, not {default}")
        shown = elements_of(smproperty)
        if name not in ("DisplacementArray", "Scalars"):  # their empty index counts as 0
            check(has(default, shown, name, smproperty), f"{label}: {shown}, not {default}")
        values = other_values(instance, name, smproperty, default)
        check(values, f"{label}: no other value is known")
        for elements in values:
            set_elements(smproperty, elements)
            proxy.SMProxy.UpdateVTKObjects()
            check_only(name, before, lambda got: has(got, elements, name, smproperty),
                       f"{label} = {elements}")
        set_elements(smproperty, shown)
        proxy.SMProxy.UpdateVTKObjects()
        check(read_all() == before, f"{label}: resetting does not restore the defaults")


def comes_from(made):
    """Returns a function that checks that data come from an algorithm. ParaView may insert its own algorithms."""
    def is_right(producers):
        if len(producers) != 1:
            return False
        producer = producers[0]
        while producer is not made and producer.GetNumberOfInputConnections(0):
            producer = producer.GetInputConnection(0, 0).GetProducer()
        return producer is made
    return is_right


def check_input(proxy, name, smproperty, sources, check_only, before):
    label = f"{proxy.GetXMLName()}.{name}"
    accepted = 0
    for source in sources:
        smproperty.SetInputConnection(0, source.SMProxy, 0)
        if smproperty.IsInDomains():
            accepted += 1
            proxy.SMProxy.UpdateVTKObjects()
            is_right = comes_from(source.GetClientSideObject())
            check_only(name, before, is_right, f"{label} = {source.GetXMLName()}")
    check(accepted > 0, f"{label} accepts none of the sources")
    smproperty.RemoveAllProxies()
    proxy.SMProxy.UpdateVTKObjects()


def check_all_reach(sources):
    for element in plugin_proxies():
        name = element.get("name")
        check(hasattr(simple, name), f"{name}: not in paraview.simple")
        simple.SetActiveSource(None)  # an active source would become the input
        with messages():  # messages about missing inputs
            proxy = getattr(simple, name)()
            missing = [
                prop.get("name")
                for prop in element
                if prop.tag.endswith("Property") and not proxy.SMProxy.GetProperty(prop.get("name"))
            ]
            check(not missing, f"{name}: ParaView has no {missing}")
            check_reach(proxy, sources)
            simple.Delete(proxy)


HUGE = 1e300
BAD_NUMBERS = [-HUGE, HUGE, 0.0, 1e-300, float("nan"), float("inf")]
BAD_TEXTS = ["", "none of these", "x" * 10000, "\u00e9\u4e2d\n\"'<>&"]
# Properties that main() tests separately.
SKIPPED = {"NumberOfNodes"}


def extremes(prop):
    """Returns values for a property, and whether the class accepts all of them."""
    smproperty = prop.SMProperty
    kind = smproperty.GetClassName()
    if kind == "vtkSMProperty":
        return []  # a button
    count = len(prop)
    if kind == "vtkSMStringVectorProperty":
        if count == 5:
            return [["POINTS", text] for text in BAD_TEXTS] + [["CELLS", "RTData"]]
        repeated = smproperty.GetRepeatable()
        return [[text, text] if repeated else text for text in BAD_TEXTS]
    if smproperty.GetRepeatable():
        return [[number, number] for number in BAD_NUMBERS[:4]] + [[]]
    if kind == "vtkSMDoubleVectorProperty":
        return [number if count == 1 else [number] * count for number in BAD_NUMBERS]
    if kind == "vtkSMIntVectorProperty":
        numbers = [-(2**31), -1, 0, 1, 2, 2**31 - 1]
        return [number if count == 1 else [number] * count for number in numbers]
    raise AssertionError(f"{kind} has no extremes")


def update(proxy):
    with messages() as texts:
        proxy.UpdatePipeline()
        proxy.UpdatePipelineInformation()
    return texts


def check_extremes(make, names):
    tried = 0
    proxy = make()
    check_silent(update(proxy))
    for name in names or proxy.ListProperties():
        prop = proxy.GetProperty(name)
        if prop is None or prop.SMProperty.GetInformationOnly() or name in SKIPPED | REMOVED:
            continue
        if prop.SMProperty.IsA("vtkSMProxyProperty"):
            continue
        for value in extremes(prop):
            proxy = make()
            label = f"{proxy.GetXMLName()}.{name} = {str(value)[:50]!r}"
            try:
                proxy.SetPropertyWithName(name, value)
            except (ValueError, TypeError, RuntimeError):
                continue  # the enumeration has no such entry
            texts = update(proxy)
            check(len(texts) <= 1, f"{label}: {len(texts)} messages:\n" + "\n".join(texts))
            check(not texts or len(texts[0]) > 40, f"{label}: {texts}")
            tried += 1
            simple.Delete(proxy)
    check_silent(update(make()))
    return tried


def check_limits(make):
    """Checks that panels offer only values that the class accepts. TestProxies.py checks properties that the class
    clamps."""
    for name, smproperty in properties_of(make()).items():
        enumeration = smproperty.FindDomain("vtkSMEnumerationDomain")
        kind = re.sub("VectorProperty$", "RangeDomain", smproperty.GetClassName())
        interval = smproperty.FindDomain(kind)
        good, bad = [], []
        if hasattr(make().GetClientSideObject(), f"Get{name}MaxValue"):
            continue
        if name == "FadeDistance":
            continue  # it has an effect only with the outside mode Keep
        if enumeration:
            good = [enumeration.GetEntryValue(i) for i in range(enumeration.GetNumberOfEntries())]
            bad = [max(good) + 1]
        elif interval and interval.GetClassName() == kind:  # other classes of domains depend on the data
            if interval.GetMinimumExists(0):
                bad.append(interval.GetMinimum(0) - 1)
            if interval.GetMaximumExists(0):
                good.append(interval.GetMaximum(0))
                bad.append(1.01 * interval.GetMaximum(0))
        for value in good + bad:
            proxy = make()
            proxy.SMProxy.GetProperty(name).SetElement(0, value)
            proxy.SMProxy.UpdateVTKObjects()
            texts = update(proxy)
            expected = 0 if value in good else 1
            check(len(texts) == expected, f"{proxy.GetXMLName()}.{name} = {value}: {texts}")
            simple.Delete(proxy)


def check_shown(make):
    """Checks that panels show current values after an update, without a request for them."""
    proxy = make()
    instance = proxy.GetClientSideObject()
    information = {
        name: smproperty
        for name, smproperty in properties_of(proxy, information=True).items()
        # ParaView computes these properties from several numbers.
        if name not in ("TimestepValues", "TimeRange")
    }
    before = {name: read(instance, name, smproperty) for name, smproperty in information.items()}
    proxy.UpdatePipeline()
    after = {name: read(instance, name, smproperty) for name, smproperty in information.items()}
    check(not information or before != after, f"{proxy.GetXMLName()}: the update changes nothing")
    for name, smproperty in information.items():
        shown = elements_of(smproperty)
        label = f"{proxy.GetXMLName()}.{name}"
        check(shown == after[name], f"{label}: {shown} is shown, not {after[name]}")
    simple.Delete(proxy)


def check_restored(proxy):
    """Checks that the button Restore Defaults of a new filter changes nothing."""
    for name, smproperty in properties_of(proxy).items():
        if not smproperty.IsA("vtkSMVectorProperty") or smproperty.GetNoCustomDefault():
            continue
        before = elements_of(smproperty)
        smproperty.ResetToDefault()
        after = elements_of(smproperty)
        # Values that the test itself has set are not defaults.
        check(before == after or name in SET_BY_TEST, f"{proxy.GetXMLName()}.{name}: {before} becomes {after}")
    simple.Delete(proxy)


def check_background(volume):
    """Checks that the background is the least value if the type of the scalars has negative numbers, and otherwise
    0."""
    shift = simple.Calculator(Input=volume, ResultArrayName="HU", Function="RTData-1100")
    whole = simple.Calculator(Input=volume, ResultArrayName="Index", Function="coordsX-20")
    whole.ResultArrayType = "Short"
    bytes_ = simple.Calculator(Input=volume, ResultArrayName="Byte", Function="coordsX+20")
    bytes_.ResultArrayType = "Unsigned Char"
    vectors = simple.Calculator(Input=volume, ResultArrayName="V", Function="-1*coords")
    for source in (shift, whole, bytes_, vectors):
        source.UpdatePipeline()
    least = shift.PointData["HU"].GetRange()[0]
    check(least < -800, f"the least value is {least}")
    # Adding active vectors does not change the active scalars.
    first = volume.PointData["RTData"].GetRange()[0]
    for source, expected in ((shift, least), (whole, -26.0), (bytes_, 0.0), (vectors, first)):
        filter_ = simple.DeformVolume(Volume=source)
        name, got = source.ResultArrayName, filter_.BackgroundValue
        check(got == expected, f"{name}: the background is {got}, not {expected}")
        reached = filter_.GetClientSideObject().GetBackgroundValue()
        check(reached == expected, f"{name}: the filter has {reached}")
    for value in (0.0, 7.0):
        filter_ = simple.DeformVolume(Volume=shift, BackgroundValue=value)
        check(filter_.BackgroundValue == value, f"The background {value} is not kept")
        filter_.Volume = whole
        filter_.UpdatePipeline()
        check(filter_.BackgroundValue == value, f"Another volume changes the background {value}")


def check_places():
    """Checks that widgets start in the middle of the data."""
    volume = simple.Wavelet(WholeExtent=[0, 10, 0, 20, 0, 30])
    volume.UpdatePipeline()
    handle = simple.DeformationHandleInData(Data=volume)
    plane = simple.CutVolumeWithPlane(Volume=volume).Plane
    places = [handle.RestPosition, handle.Position, plane.Center]
    carve = simple.CarveVolume(Volume=volume)
    for name in ("Sphere", "Cylinder"):
        carve.Body = name
        places.append(carve.Body.Center)
    carve.Body = "Plane"
    places.append(carve.Body.Origin)
    check(all(list(place) == [5, 10, 15] for place in places), f"The default places are {places}")
    carve.Body = "Box"
    check(list(carve.Body.Length) == [10, 20, 30], f"The default length is {list(carve.Body.Length)}")


def check_defaults(volume):
    # If there is only one array of vectors, it is found, whatever its name and whatever other arrays there are.
    mesh = bent_lattice(volume, array="u")
    filter_ = deformed(volume, mesh)
    check(list(filter_.DisplacementArray) == ["POINTS", "u"], f"DisplacementArray is {filter_.DisplacementArray}")
    check(list(filter_.CustomBounds) == [-6.0, 6.0] * 3, f"CustomBounds is {list(filter_.CustomBounds)}")
    check(filter_.Device == "best", f"Device is {filter_.Device}")
    # Panels offer only images as the reference image.
    blocks = simple.GroupDatasets(Input=[volume])
    blocks.UpdatePipeline()
    reference = simple.DeformVolume(Volume=volume).SMProxy.GetProperty("Reference")
    reference.SetInputConnection(0, blocks.SMProxy, 0)
    check(not reference.IsInDomains(), "A composite dataset is offered as the reference image")
    check(list(filter_.CategoricalArrays) == [], f"CategoricalArrays is {list(filter_.CategoricalArrays)}")
    # Of several arrays of vectors, the active one is chosen.
    two = simple.Calculator(Input=mesh)
    two.ResultArrayName = "a"
    two.Function = "2*coordsX*iHat"
    two.UpdatePipeline()
    filter_ = deformed(volume, two)
    check(list(filter_.DisplacementArray) == ["POINTS", "a"], f"DisplacementArray is {filter_.DisplacementArray}")
    filter_.DisplacementArray = ["POINTS", "u"]
    check_silent(update(filter_))
    # Information properties about the last update.
    check(filter_.DeviceInUse, "No device is in use")
    check(filter_.ResamplerInUse == "Exact", f"ResamplerInUse is {filter_.ResamplerInUse}")
    check(filter_.InvertedTetrahedra == 0.0, f"InvertedTetrahedra is {filter_.InvertedTetrahedra}")
    check(filter_.CoveredVoxels > 1000.0, f"CoveredVoxels is {filter_.CoveredVoxels}")
    extent = filter_.GetDataInformation().GetExtent()
    check(
        list(filter_.ChangedExtent) == list(extent),
        f"ChangedExtent is {list(filter_.ChangedExtent)}, not {list(extent)}",
    )
    check("Seconds for resampling" in filter_.Summary, filter_.Summary)
    check(filter_.DeviceMemory > 0.0, f"DeviceMemory is {filter_.DeviceMemory}")
    filter_.ReleaseDeviceMemory()
    filter_.UpdatePipelineInformation()
    check(filter_.DeviceMemory == 0.0, f"{filter_.DeviceMemory} bytes are left")
    # Panels show current information after an update, without a request for it.
    def shown(name):
        return filter_.SMProxy.GetProperty(name).GetElement(0)

    stretched = bent_lattice(volume, function="0.5*coordsX*iHat")
    filter_ = simple.DeformVolume(Volume=volume, Deformation=stretched)
    check(
        shown("NumberOfCoveredVoxels") == 0.0 and shown("Summary") == "",
        "Before an update NumberOfCoveredVoxels and Summary must be empty",
    )
    for scale, covered in ((0.0, 13 * 13 * 13), (2.0, 25 * 13 * 13)):
        filter_.DisplacementScale = scale
        filter_.UpdatePipeline()
        got = shown("NumberOfCoveredVoxels")
        check(got == covered, f"{got} covered voxels are shown, not {covered}")
        check(shown("DeviceInUse") != "", "No device is shown")
        check(f"Covered voxels: {covered:,}\n" in shown("Summary"), shown("Summary"))
        check("Inverted tetrahedra: 0\n" in shown("Summary"), shown("Summary"))

    # If the volume is turned inside out, tetrahedra are inverted and counted.
    filter_ = deformed(volume, two)
    filter_.DisplacementArray = ["POINTS", "a"]
    filter_.DisplacementScale = -1.0
    filter_.UpdatePipeline()
    filter_.UpdatePipelineInformation()
    check(
        filter_.InvertedTetrahedra == 5 * 12**3,
        f"InvertedTetrahedra is {filter_.InvertedTetrahedra}, not {5 * 12**3}",
    )


def main():
    load_plugin()
    volume = wavelet(6)
    mesh = bent_lattice(volume)
    volume.UpdatePipeline()
    ball = simple.Sphere()
    ball.UpdatePipeline()
    check_all_reach([volume, mesh, ball])

    def deform(**properties):
        # With a memory limit, an output that is too large is an error, and does not fill the memory of the machine.
        return simple.DeformVolume(
            Volume=volume, Deformation=mesh, MemoryLimit=2.0e8, **properties
        )

    def body():
        return simple.TetGenMesher(
            Input=volume, AutomaticIsovalue=0, Isovalue=150.0, TargetEdgeLength=4.0
        )

    plane = simple.Plane(Origin=[0.5, -9, -9], Point1=[0.5, 9, -9], Point2=[0.5, -9, 9])
    surface = simple.Sphere(Radius=4)
    labels = simple.Calculator(Input=volume, ResultArrayName="label", Function="floor(coordsX/4)")
    lattice = simple.TetrahedralLattice(NumberOfNodes=[4, 4, 4], Bounds=[-6, 6] * 3)
    wide = simple.TetrahedralLattice(NumberOfNodes=[5, 5, 5], Bounds=[-20, 20] * 3)
    held = simple.Calculator(Input=lattice, ResultArrayName="Fixed", Function="coordsZ < -5")
    handle = simple.DeformationHandle(RestPosition=[0, 0, 6], Position=[1, 0, 6])
    edited = {"Volume": volume, "Deformation": mesh}
    elastic = {"RestMesh": held, "Handles": handle}
    makers = {
        "CarveVolume": lambda: simple.CarveVolume(ToolPositions=[1, 2, 3], **edited),
        "CarveVolumeLabel": lambda: simple.CarveVolumeLabel(Volume=labels, Labels="label"),
        "CarveVolumeWithSurface": lambda: simple.CarveVolumeWithSurface(Surface=surface, **edited),
        "ChainMailDeformation": lambda: simple.ChainMailDeformation(Volume=volume, Handles=handle),
        "CorotationalDeformation": lambda: simple.CorotationalDeformation(**elastic),
        "FiniteElementDeformation": lambda: simple.FiniteElementDeformation(**elastic),
        "CutVolume": lambda: simple.CutVolume(Sheet=plane, **edited),
        "CutVolumeWithPlane": lambda: simple.CutVolumeWithPlane(**edited),
        "DeformGeometry": lambda: simple.DeformGeometry(Input=surface, Deformation=mesh),
        "DeformVolume": deform,
        "DeformationHandle": simple.DeformationHandle,
        "DeformationHandleInData": lambda: simple.DeformationHandleInData(Data=volume),
        "MassSpringDeformation": lambda: simple.MassSpringDeformation(**elastic),
        "MaterialFromVolume": lambda: simple.MaterialFromVolume(Mesh=wide, Volume=volume),
        "TetGenMesher": body,
        "TetrahedralLattice": simple.TetrahedralLattice,
        "TetrahedralLatticeOfVolume": lambda: simple.TetrahedralLatticeOfVolume(Volume=volume),
    }

    tried = 0
    for element in plugin_proxies():
        name = element.get("name")
        check(name in makers, f"There is no test of {name}")
        tried += check_extremes(makers[name], None)
        check_limits(makers[name])
        check_shown(makers[name])
        check_restored(makers[name]())
    tried += check_extremes(lambda: deform(OutputBoundsMode="Custom Bounds"), ["CustomBounds"])
    tried += check_extremes(lambda: deform(OutputSpacingMode="Custom Spacing"), ["CustomSpacing"])
    tried += check_extremes(lambda: deform(Resampler="Mesh Rasterization"), ["Interpolation"])
    tried += check_extremes(lambda: simple.TetGenMesher(Input=ball), ["TargetEdgeLength"])
    check(tried > 500, f"Only {tried} values were tried")
    lattice = simple.TetrahedralLattice(NumberOfNodes=[-5, 2**31 - 1, 0])
    check(len(update(lattice)) == 1, "Too few nodes must be one error")
    lattice.NumberOfNodes = [2**31 - 1] * 3
    check(len(update(lattice)) == 1, "Too many nodes must be one error")
    check_defaults(volume)
    check_background(volume)
    check_places()


main()
