# SPDX-License-Identifier: BSD-3-Clause
"""Every property of every proxy, set to its extremes: the process lives, an error is one readable
message, and the defaults work afterwards. Then the defaults themselves."""

from paraview import simple

from PluginTesting import (
    bent_lattice,
    check,
    check_silent,
    deformed,
    load_plugin,
    messages,
    wavelet,
)

HUGE = 1e300
BAD_NUMBERS = [-HUGE, HUGE, 0.0, 1e-300, float("nan"), float("inf")]
BAD_TEXTS = ["", "none of these", "x" * 10000, "\u00e9\u4e2d\n\"'<>&"]
# Has a part of its own.
SKIPPED = {"NumberOfNodes"}


def extremes(prop):
    """Values for a property, and whether the class accepts them all."""
    smproperty = prop.SMProperty
    kind = smproperty.GetClassName()
    if kind == "vtkSMProperty":
        return []  # a command
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
    return []


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
        if prop is None or prop.SMProperty.GetInformationOnly() or name in SKIPPED:
            continue
        if prop.SMProperty.IsA("vtkSMProxyProperty"):
            continue
        for value in extremes(prop):
            proxy = make()
            label = f"{proxy.GetXMLName()}.{name} = {str(value)[:50]!r}"
            try:
                proxy.SetPropertyWithName(name, value)
            except (ValueError, TypeError, RuntimeError):
                continue  # not an entry of the enumeration
            texts = update(proxy)
            check(len(texts) <= 1, f"{label}: {len(texts)} messages:\n" + "\n".join(texts))
            check(not texts or len(texts[0]) > 40, f"{label}: {texts}")
            tried += 1
            simple.Delete(proxy)
    check_silent(update(make()))
    return tried


def check_defaults(volume):
    # The only vectors are found whatever their name, and whatever other arrays there are.
    mesh = bent_lattice(volume, array="u")
    filter_ = deformed(volume, mesh)
    check(list(filter_.DisplacementArray) == ["POINTS", "u"], f"{filter_.DisplacementArray}")
    check(list(filter_.CustomBounds) == [-6.0, 6.0] * 3, f"{list(filter_.CustomBounds)}")
    check(filter_.Device == "best", filter_.Device)
    check(list(filter_.CategoricalArrays) == [], f"{list(filter_.CategoricalArrays)}")
    # Of several, the active ones.
    two = simple.Calculator(Input=mesh)
    two.ResultArrayName = "a"
    two.Function = "2*coordsX*iHat"
    two.UpdatePipeline()
    filter_ = deformed(volume, two)
    check(list(filter_.DisplacementArray) == ["POINTS", "a"], f"{filter_.DisplacementArray}")
    filter_.DisplacementArray = ["POINTS", "u"]
    check_silent(update(filter_))
    # What the last update did.
    check(filter_.DeviceInUse and filter_.DeviceInUse in list(filter_.GetProperty("DeviceChoices")),
          f"The device in use is {filter_.DeviceInUse}")
    check(filter_.ResamplerInUse == "Exact", f"{filter_.ResamplerInUse}")
    check(filter_.InvertedTetrahedra == 0.0, f"{filter_.InvertedTetrahedra}")
    check(filter_.CoveredVoxels > 1000.0, f"{filter_.CoveredVoxels}")
    extent = filter_.GetDataInformation().GetExtent()
    check(list(filter_.ChangedExtent) == list(extent), f"{list(filter_.ChangedExtent)} changed")
    check(filter_.ResamplingTime > 0.0 and filter_.DeviceMemory > 0.0, "No time or no memory")
    check(filter_.CompilationTime >= 0.0, f"{filter_.CompilationTime}")
    filter_.ReleaseDeviceMemory()
    filter_.UpdatePipelineInformation()
    check(filter_.DeviceMemory == 0.0, f"{filter_.DeviceMemory} bytes are left")
    # Panels show what is there after an update, without asking for it.
    def shown(name):
        return filter_.SMProxy.GetProperty(name).GetElement(0)

    stretched = bent_lattice(volume, function="0.5*coordsX*iHat")
    filter_ = simple.DeformVolume(Volume=volume, Deformation=stretched)
    check(shown("NumberOfCoveredVoxels") == 0.0 and shown("Summary") == "", "Nothing was updated")
    for scale, covered in ((0.0, 13 * 13 * 13), (2.0, 25 * 13 * 13)):
        filter_.DisplacementScale = scale
        filter_.UpdatePipeline()
        got = shown("NumberOfCoveredVoxels")
        check(got == covered, f"{got} covered voxels are shown, not {covered}")
        check(shown("DeviceInUse") != "", "No device is shown")
        check(f"Covered voxels: {covered:,}\n" in shown("Summary"), shown("Summary"))
        check("Inverted tetrahedra: 0\n" in shown("Summary"), shown("Summary"))
    mesher = simple.TetGenMesher(Input=volume, AutomaticIsovalue=0, Isovalue=150.0)
    mesher.UpdatePipeline()
    check(mesher.SMProxy.GetProperty("UsedIsovalue").GetElement(0) == 150.0, "No isovalue is shown")

    # Folded over, tetrahedra are inverted and counted.
    filter_ = deformed(volume, two)
    filter_.DisplacementArray = ["POINTS", "a"]
    filter_.DisplacementScale = -1.0
    filter_.UpdatePipeline()
    filter_.UpdatePipelineInformation()
    check(filter_.InvertedTetrahedra == 5 * 12**3, f"{filter_.InvertedTetrahedra} are inverted")


def main():
    load_plugin()
    volume = wavelet(6)
    mesh = bent_lattice(volume)
    volume.UpdatePipeline()
    ball = simple.Sphere()
    ball.UpdatePipeline()

    def deform(**properties):
        # An output that is too large is an error before it fills this machine.
        return simple.DeformVolume(
            Volume=volume, Deformation=mesh, MemoryLimit=2.0e8, **properties
        )

    def body():
        return simple.TetGenMesher(
            Input=volume, AutomaticIsovalue=0, Isovalue=150.0, TargetEdgeLength=4.0
        )

    tried = check_extremes(deform, None)
    tried += check_extremes(lambda: deform(OutputBoundsMode="Custom Bounds"), ["CustomBounds"])
    tried += check_extremes(lambda: deform(OutputSpacingMode="Custom Spacing"), ["CustomSpacing"])
    tried += check_extremes(lambda: deform(Resampler="Mesh Rasterization"), ["Interpolation"])
    tried += check_extremes(simple.TetrahedralLattice, None)
    tried += check_extremes(lambda: simple.TetrahedralLatticeOfVolume(Volume=volume), None)
    tried += check_extremes(body, None)
    tried += check_extremes(lambda: simple.TetGenMesher(Input=ball), ["TargetEdgeLength"])
    check(tried > 150, f"Only {tried} values were tried")
    lattice = simple.TetrahedralLattice(NumberOfNodes=[-5, 2**31 - 1, 0])
    check(len(update(lattice)) == 1, "Too few nodes are no error")
    lattice.NumberOfNodes = [2**31 - 1] * 3
    check(len(update(lattice)) == 1, "Too many nodes are no error")
    check_defaults(volume)


main()
