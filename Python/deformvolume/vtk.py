# SPDX-License-Identifier: BSD-3-Clause
"""DeformVolume, a filter for VTK pipelines in Python, for VTK 9.1 and later.

Its methods and constants have the names of those of the C++ class vtkDeformVolumeFilter, which must be compiled for one
version of VTK. Its results are bitwise equal to those of that class. It has only the properties that are listed in
DeformVolume: methods of other properties raise AttributeError.
"""

import numbers
import sys

import numpy
from vtkmodules.util.numpy_support import get_vtk_array_type, vtk_to_numpy
from vtkmodules.util.vtkAlgorithm import VTKPythonAlgorithmBase
from vtkmodules.vtkCommonCore import (
    VTK_BIT,
    VTK_CHAR,
    VTK_DOUBLE,
    VTK_FLOAT,
    VTK_UNSIGNED_CHAR,
    vtkDataArray,
    vtkIdList,
    vtkOutputWindow,
)
from vtkmodules.vtkCommonDataModel import (
    VTK_POLYHEDRON,
    vtkCompositeDataSet,
    vtkDataObject,
    vtkDataSetAttributes,
    vtkExplicitStructuredGrid,
    vtkImageData,
    vtkRectilinearGrid,
    vtkStructuredGrid,
    vtkUnstructuredGrid,
)
from vtkmodules.vtkCommonExecutionModel import vtkAlgorithm, vtkStreamingDemandDrivenPipeline
from vtkmodules.vtkFiltersCore import vtkAppendFilter

from . import _deformer, _native, _structs

_OUTSIDE = tuple(_structs.OUTSIDE)
_INTERPOLATION = tuple(_structs.INTERPOLATION)
_BOUNDS = ("deformed", "volume")
# The constants of each property that has some.
_CONSTANTS = {
    "OutsideMode": [name.upper() for name in _OUTSIDE],
    "Interpolation": [f"{name.upper()}_INTERPOLATION" for name in _INTERPOLATION],
    "OutputBoundsMode": [f"{name.upper()}_BOUNDS" for name in _BOUNDS],
}
_ALL_TETRAHEDRA = 31
_HIDDEN_BY_EDIT = 128  # of vtkVolumeEditAlgorithm::BlankCells
_NO_SOURCE = vtkDataSetAttributes.DUPLICATEPOINT | vtkDataSetAttributes.HIDDENPOINT
_TIMES = vtkStreamingDemandDrivenPipeline.TIME_STEPS(), vtkStreamingDemandDrivenPipeline.TIME_RANGE()
_NO_CELL = vtkDataSetAttributes.DUPLICATECELL | vtkDataSetAttributes.HIDDENCELL
_VALID = "vtkValidPointMask"
# Arrays of ghosts and of edits are masks of the volume, and are not resampled.
_POINT_MASKS = ("vtkGhostType", _VALID, "BoundaryDistance", "CutDistance")
_CELL_MASKS = ("ActiveTetrahedra", "CutTetrahedra", "vtkGhostType")
# The arrays that the output has in addition, and their settings.
_GENERATED = {
    "RestPosition": "GenerateRestPositions",
    "Jacobian": "GenerateJacobian",
    "FoldCount": "GenerateFoldCount",
}


def _direction(image):
    matrix = image.GetDirectionMatrix()
    return [matrix.GetElement(row, column) for row in range(3) for column in range(3)]


def _grid_of(image):
    return _deformer.make_grid(image.GetExtent(), image.GetOrigin(), image.GetSpacing(), _direction(image))


def _view(array, shape):
    """Returns a numpy view of a VTK array over a grid. Axes: z, y, x and, for several components, an axis of these."""
    components = array.GetNumberOfComponents()
    count = int(numpy.prod(shape))
    if array.GetNumberOfTuples() != count:
        raise ValueError(
            f'The array "{array.GetName()}" has {array.GetNumberOfTuples()} tuples, but its grid needs {count}. Remove '
            "the array, or give it one tuple for each point or cell."
        )
    return vtk_to_numpy(array).reshape(tuple(shape) + ((components,) if components > 1 else ()))


def _stamp(*objects):
    """Returns a value that differs after an object has been replaced or modified."""

    def stamp(one):
        # __this__ has the address of the VTK object. id() differs each time Python wraps it.
        stamps = (one.__this__, one.GetMTime())
        if isinstance(one, vtkDataArray):
            # Arrays are borrowed. Resizing allocates other memory, but does not always change the time.
            values = vtk_to_numpy(one)
            stamps += (values.ctypes.data, values.size)
        if isinstance(one, vtkRectilinearGrid):  # its time leaves out that of its coordinates
            stamps += _stamp(one.GetXCoordinates(), one.GetYCoordinates(), one.GetZCoordinates())
        return stamps

    return tuple(None if one is None else stamp(one) for one in objects)


def _find_blocks(data):
    """Returns the blocks of a composite dataset, or a list of other data."""
    if not isinstance(data, vtkCompositeDataSet):
        return [data]
    blocks, leaves = [], data.NewIterator()
    while not leaves.IsDoneWithTraversal():
        blocks.append(leaves.GetCurrentDataObject())
        leaves.GoToNextItem()
    return blocks


def _shape_stamp(mesh):
    """Returns a stamp of the points and cells of a mesh, without its arrays."""
    cells = mesh.GetCells()
    parts = (mesh.GetPoints(), cells, cells.GetConnectivityArray(), cells.GetOffsetsArray(), _cell_types(mesh))
    parts += (*_find_cell_masks(mesh), mesh.GetCellData().GetHigherOrderDegrees())
    # Modified() of the mesh stands for all that it has, but GetMTime() is also that of its arrays.
    arrays = max(mesh.GetPointData().GetMTime(), mesh.GetCellData().GetMTime(), mesh.GetFieldData().GetMTime())
    return _stamp(*parts) + (mesh.__this__, mesh.GetMTime() if mesh.GetMTime() > arrays else 0)


def _find_cell_masks(mesh):
    points = mesh.GetPointData()
    return mesh.GetCellData().GetArray("vtkGhostType"), points.GetArray("vtkGhostType"), points.GetArray(_VALID)


def _find_used_cells(mesh, connectivity, offsets):
    """Returns which cells are neither hidden nor duplicate, and have no hidden point; None: all."""
    cell_ghosts = _find_cell_masks(mesh)[0]
    hidden = _find_hidden_points(mesh)
    used = numpy.ones(mesh.GetNumberOfCells(), bool)
    if cell_ghosts is not None:
        used &= (_view(cell_ghosts, used.shape) & _NO_CELL) == 0
    if hidden is not None:
        # Indices that do not exist are errors of the engine.
        exists = (connectivity >= 0) & (connectivity < hidden.size)
        counts = numpy.concatenate(([0], numpy.cumsum(exists & hidden[numpy.where(exists, connectivity, 0)])))
        used &= counts[offsets[1:]] == counts[offsets[:-1]]
    return None if used.all() else used


def _cell_types(mesh):
    try:
        return mesh.GetCellTypes()  # from VTK 9.6 on
    except TypeError:
        return mesh.GetCellTypesArray()


def _find_degrees(mesh, used):
    """Returns the degrees of Lagrange cells along their axes; None if they follow from the numbers of points."""
    array = mesh.GetCellData().GetHigherOrderDegrees()
    if array is None:
        return None
    if array.GetNumberOfComponents() != 3:
        raise ValueError(
            f"The higher order degrees of the cells have {array.GetNumberOfComponents()} components. Give them three."
        )
    degrees = _view(array, (mesh.GetNumberOfCells(),))
    # A degree that is not valid is an error of the engine.
    degrees = numpy.where((degrees >= 1) & (degrees < 1e6), degrees, 0)
    return numpy.ascontiguousarray(degrees if used is None else degrees[used], dtype=numpy.int32)


def _find_faces(mesh, types, used):
    """Returns the faces of the polyhedra, in the form of the library; None if there are none. types: of the cells that
    are used."""
    cells = numpy.flatnonzero(types == VTK_POLYHEDRON)
    if cells.size == 0:
        return None
    if used is not None:
        cells = numpy.flatnonzero(used)[cells]
    stream, faces = vtkIdList(), []
    for cell in cells.tolist():
        mesh.GetFaceStream(cell, stream)
        faces.extend(stream.GetId(number) for number in range(stream.GetNumberOfIds()))
    return numpy.array(faces, dtype=numpy.int64)


def _name_arrays(data, masks):
    """Returns pairs of an array and its name in messages: all arrays of point or cell data but these masks."""
    arrays = [data.GetAbstractArray(number) for number in range(data.GetNumberOfArrays())]
    return [
        (array, f'"{array.GetName()}"' if array.GetName() else f"number {number}")
        for number, array in enumerate(arrays)
        if array.GetName() not in masks
    ]


def _describe_cell_arrays(data):
    """Returns a sentence for errors of missing point arrays, which names the cell arrays; "" if there are none."""
    names = ", ".join(name for _, name in _name_arrays(data.GetCellData(), _CELL_MASKS))
    method = "cells_to_points" if isinstance(data, vtkImageData) else "cell_data_to_point_data"
    advice = f"Convert these by vtkCellDataToPointData, or by {method}() of pyvista."
    return f" Its cell arrays: {names}. {advice}" if names else ""


def _describe_arrays(data):
    """Returns sentences for errors of missing point arrays, which name the arrays."""
    names = ", ".join(name for _, name in _name_arrays(data.GetPointData(), _POINT_MASKS)) or "none"
    return f" Its point arrays: {names}." + _describe_cell_arrays(data)


def _find_hidden_points(data):
    """Returns a mask of the points that are hidden or not valid; None if there are none."""
    ghosts, valid = data.GetPointData().GetArray("vtkGhostType"), data.GetPointData().GetArray(_VALID)
    hidden = numpy.zeros(data.GetNumberOfPoints(), bool)
    if ghosts is not None:
        hidden |= (_view(ghosts, hidden.shape) & vtkDataSetAttributes.HIDDENPOINT) != 0
    if valid is not None:
        hidden |= _view(valid, hidden.shape) == 0
    return hidden if hidden.any() else None


def _is_numeric(array):
    # numpy_support copies arrays of bits, so that the library could not write their output.
    return isinstance(array, vtkDataArray) and array.GetDataType() != VTK_BIT


class DeformVolume(VTKPythonAlgorithmBase):
    """Deforms a volume by a tetrahedral mesh or a displacement field.

    Ports:
        0: vtkImageData, the volume. Ghost points, points whose vtkValidPointMask is 0, and tetrahedra that
            vtkCutVolume and vtkCarveVolume have switched off, are left out.
        1, optional: a mesh (vtkUnstructuredGrid, vtkStructuredGrid, vtkExplicitStructuredGrid, vtkRectilinearGrid or a
            composite dataset of these) with displacements of its points; or vtkImageData with vectors, a displacement
            field. Without it the output is the volume itself.
            Cells of a mesh that vtkGhostType marks as hidden or duplicate are left out, and cells with a point that it
            hides or whose vtkValidPointMask is 0. Such points of a field are undefined: voxels whose interpolation
            would use one are not covered. If only displacements change between updates, a vtkUnstructuredGrid
            is faster than the other meshes.
            SetInputArrayToProcess(0, 1, 0, vtkDataObject.FIELD_ASSOCIATION_POINTS, name) chooses the array of three
            components, in world units. Default: the active vectors, or else the only array of three components that
            is neither normals nor of unsigned char, as colors are.
        2, optional: the mesh at rest. The points of port 1 are then deformed positions.
        3, optional: vtkImageData with the grid of the output.

    Properties, each with Set and Get:
        OutsideMode: DISCARD (default), EXTRAPOLATE or KEEP voxels outside the mesh or the field.
        FadeDistance: with KEEP, the distance over which the displacement of the boundary fades to zero, in world units;
            0 by default.
        Interpolation: LINEAR_INTERPOLATION (default), CUBIC_INTERPOLATION or NEAREST_INTERPOLATION.
        BackgroundValue: value of voxels outside the deformed volume; 0 by default. In arrays of integers it is
            rounded, and limited to the range of the type; NaN becomes 0.
        FieldIsInverse: whether a field leads from the output to the volume; off by default.
        OutputBoundsMode: DEFORMED_BOUNDS (default) or VOLUME_BOUNDS.
        GenerateRestPositions, GenerateJacobian, GenerateFoldCount: whether the output has the arrays RestPosition,
            Jacobian and FoldCount; off by default.
        Device: a name of deformvolume.devices(), a part of a name, "cpu", "gpu", or "" (default): the best device.
    AddCategoricalArray(name) and ClearCategoricalArrays() choose arrays of labels, AddDensityArray(name) and
    ClearDensityArrays() amounts per unit of volume.

    Folds cause no warning: see GetNumberOfInvertedTetrahedra(). Warnings are displayed as VTK's are. If pyvista is
    imported, which hides those, they are Python warnings (deformvolume.DeformationWarning).

    The output is vtkImageData with the arrays of the volume and "vtkValidPointMask": 1 for voxels that the deformed
    volume covers. Updates read the whole inputs; with MPI, each rank uses only the inputs that it has itself. If inputs
    have several time steps, the grid of the output must be the same at all of them: use VOLUME_BOUNDS or a reference
    image. Update() and UpdateTimeStep(), UpdateWholeExtent(), UpdateExtent() and UpdatePiece() raise an exception for
    each error, and KeyboardInterrupt after Ctrl-C or SetAbortExecute(1); the output is then empty. If the filter is
    updated by a downstream filter, VTK prints the error.
    """

    DISCARD, EXTRAPOLATE, KEEP = range(3)
    LINEAR_INTERPOLATION, CUBIC_INTERPOLATION, NEAREST_INTERPOLATION = range(3)
    DEFORMED_BOUNDS, VOLUME_BOUNDS = range(2)

    def __init__(self):
        VTKPythonAlgorithmBase.__init__(self, nInputPorts=4, nOutputPorts=1, outputType="vtkImageData")
        self._settings = {
            "OutsideMode": 0,
            "FadeDistance": 0.0,
            "Interpolation": 0,
            "BackgroundValue": 0.0,
            "FieldIsInverse": False,
            "OutputBoundsMode": 0,
            "GenerateRestPositions": False,
            "GenerateJacobian": False,
            "GenerateFoldCount": False,
            "Device": "",
        }
        self._categorical = set()
        self._densities = set()
        self._counts = {}
        self._device = ""
        self._warned = set()
        self._converters = {}
        self._deformer = None
        self._stamps = {}
        self._error = None
        self._messages = []
        self._last_error = None
        self._announced = b""
        self._inputs = ()
        self._is_updating = False

    # ---- Properties

    def __setattr__(self, name, value):
        # Python would accept attributes that no method reads, such as filter.OutsideMode = 2.
        if name.startswith("_") or name in ("InputType", "OutputType") or hasattr(type(self), name):
            super().__setattr__(name, value)
        else:
            raise AttributeError(
                f"DeformVolume has no attribute {name}. Set properties by methods, such as SetOutsideMode()."
            )

    def __getattr__(self, name):
        settings = self.__dict__.get("_settings", {})
        if name[:3] == "Get" and name[3:] in settings:
            return lambda: settings[name[3:]]
        if name[:3] == "Set" and name[3:] in settings:
            return lambda value: self._set(name[3:], value)
        for ending, value in (("On", True), ("Off", False)):
            stem = name[: -len(ending)]
            if name.endswith(ending) and isinstance(settings.get(stem), bool):
                return lambda: self._set(stem, value)
        raise AttributeError(
            f"DeformVolume has no {name}. help(DeformVolume) lists its properties, such as OutsideMode. The C++ class "
            "vtkDeformVolumeFilter may have it. That class is in the Python package deformvolume_vtk, which must be "
            "built from source."
        )

    def _set(self, name, value):
        before = self._settings[name]
        accepted, wanted = {
            str: (str, "a text"),
            float: (numbers.Real, "a number"),
            int: (numbers.Integral, " or ".join(f"DeformVolume.{one}" for one in _CONSTANTS.get(name, ()))),
            bool: ((numbers.Integral, numpy.bool_), "True or False"),
        }[type(before)]
        if not isinstance(value, accepted):
            raise TypeError(f"{name} is {value!r}. Give {wanted}.")
        value = type(before)(value)
        if name in _CONSTANTS:
            value = min(max(value, 0), len(_CONSTANTS[name]) - 1)
        if value != before:
            self._settings[name] = value
            if name == "Device":
                self._deformer = None
            self.Modified()

    def AddCategoricalArray(self, name):
        """Treats the array of this name as labels, which are not interpolated."""
        self._add_name(self._categorical, name)

    def ClearCategoricalArrays(self):
        """Treats no array as labels."""
        self._clear_names(self._categorical)

    def AddDensityArray(self, name):
        """Treats the array of this name as amounts per unit of volume, such as a dose. Its values are divided by the
        Jacobian, so that their sum is kept. They are 0, and not BackgroundValue, where the deformed volume covers no
        voxel or is inside out. The array of the output is of type double if that of the volume is, else float."""
        self._add_name(self._densities, name)

    def ClearDensityArrays(self):
        """Treats no array as amounts per unit of volume."""
        self._clear_names(self._densities)

    def _add_name(self, names, name):
        if not isinstance(name, str):
            raise TypeError(f"The name of the array is {name!r}. Give a text.")
        if name not in names:
            names.add(name)
            self.Modified()

    def _clear_names(self, names):
        if names:
            names.clear()
            self.Modified()

    def SetInputData(self, data):
        """Sets the data of port 0."""
        self.SetInputDataObject(0, data)

    def GetOutput(self):
        """Returns the output, a vtkImageData."""
        return self.GetOutputDataObject(0)

    def SetDeformationConnection(self, output):
        """Sets the connection of port 1."""
        self.SetInputConnection(1, output)

    def SetDeformationData(self, data):
        """Sets the data of port 1."""
        self.SetInputDataObject(1, data)

    def SetRestConnection(self, output):
        """Sets the connection of port 2."""
        self.SetInputConnection(2, output)

    def SetRestData(self, data):
        """Sets the data of port 2."""
        self.SetInputDataObject(2, data)

    def SetReferenceConnection(self, output):
        """Sets the connection of port 3."""
        self.SetInputConnection(3, output)

    def SetReferenceData(self, data):
        """Sets the data of port 3."""
        self.SetInputDataObject(3, data)

    def GetNumberOfCoveredVoxels(self):
        """Returns the number of voxels of the output that the deformed volume covers; 0 before the first update."""
        return self._counts.get("number_of_covered_voxels", 0)

    def GetNumberOfInvertedTetrahedra(self):
        """Returns a number that is more than 0 if the deformation folds, so that parts of the volume are seen twice."""
        return self._counts.get("number_of_inverted_tetrahedra", 0)

    def GetNumberOfHiddenVoxels(self):
        """Returns the number of voxels of tissue that the output lacks because other tissue is at the same place."""
        return self._counts.get("number_of_hidden_samples", 0)

    def GetNumberOfFlatTetrahedra(self):
        """Returns the number of tetrahedra of the deformation mesh without volume, which are left out."""
        return self._counts.get("number_of_flat_tetrahedra", 0)

    def GetDeviceInUse(self):
        """Returns the name of the device of the last update; "" before the first one."""
        return self._device

    # ---- Pipeline

    def Update(self, *arguments):
        """Updates the output. Raises an exception after an error, also if an input cannot be updated. The output is
        then empty."""
        if arguments in ((), (0,)):
            self._update(self.GetExecutive().Update)
        else:
            self._update(lambda: super(DeformVolume, self).Update(*arguments))

    def UpdateExtent(self, *arguments):
        """Like Update(), for an extent. Returns 1."""
        return self._update(lambda: super(DeformVolume, self).UpdateExtent(*arguments))

    def UpdatePiece(self, *arguments):
        """Like Update(), for a piece. Returns 1."""
        return self._update(lambda: super(DeformVolume, self).UpdatePiece(*arguments))

    def UpdateTimeStep(self, *arguments):
        """Like Update(), at a time. Returns 1."""
        return self._update(lambda: super(DeformVolume, self).UpdateTimeStep(*arguments))

    def UpdateWholeExtent(self):
        """Like Update(), for the whole extent. Returns 1."""
        return self._update(super().UpdateWholeExtent)

    def _update(self, update):
        """Calls a method of the superclass that updates the output. Raises an exception if it fails."""
        if self._is_updating:
            raise _native.Error("The filter is being updated. Its observers must not call Update().")
        # VTK does not see that the data of an input have changed if another consumer has updated it.
        if self._stamp_inputs() != self._inputs:
            self.Modified()
        self._error = None
        self._messages = []
        self._is_updating = True
        executive = self.GetExecutive()
        observer = executive.AddObserver("ErrorEvent", self._take_message)
        try:
            # UpdateWholeExtent() returns 1 also if VTK reports an error of the inputs.
            succeeded = update() not in (0, False) and self._error is None and not self._messages
        finally:
            executive.RemoveObserver(observer)
            self._is_updating = False
        if succeeded:
            self._last_error = None
            return 1
        self.GetOutputDataObject(0).Initialize()
        error, self._error = self._error, None
        state = self.GetMTime(), self.GetExecutive().GetPipelineMTime()
        if error is not None:
            # Its traceback would keep the filter alive.
            self._last_error = state, type(error), error.args
        elif self._messages:
            error = _native.Error(" ".join(self._messages))
        elif self._last_error is not None and self._last_error[0] == state:
            # VTK does not call the filter again if nothing has changed since an error.
            error = self._last_error[1](*self._last_error[2])
        else:
            error = _native.Error("An input cannot be updated. VTK has displayed the reason.")
        try:
            raise error
        finally:
            del error

    def _take_message(self, _, __, text):
        # VTK begins messages with the file and the object.
        self._messages.append(text.strip().rpartition("): ")[2])

    _take_message.CallDataType = "string0"

    def FillInputPortInformation(self, port, info):
        """Sets the data type of each port."""
        if port in (0, 3):
            info.Set(vtkAlgorithm.INPUT_REQUIRED_DATA_TYPE(), "vtkImageData")
        else:
            # With vtkDataSet as the first type, VTK would execute the filter for each block.
            info.Set(vtkAlgorithm.INPUT_REQUIRED_DATA_TYPE(), "vtkCompositeDataSet")
            info.Append(vtkAlgorithm.INPUT_REQUIRED_DATA_TYPE(), "vtkDataSet")
        if port > 0:
            info.Set(vtkAlgorithm.INPUT_IS_OPTIONAL(), 1)
        return 1

    def RequestInformation(self, request, inInfo, outInfo):
        """Announces the grid of the output. Updates the inputs, because the bounds of the output depend on them."""
        return self._guard(lambda: self._announce(outInfo.GetInformationObject(0)))

    def RequestUpdateExtent(self, request, inInfo, outInfo):
        """Requests the whole inputs, and one voxel of the reference image, whose values are not used."""
        pipeline = vtkStreamingDemandDrivenPipeline
        for port in range(4):
            for number in range(inInfo[port].GetNumberOfInformationObjects()):
                info = inInfo[port].GetInformationObject(number)
                info.Set(pipeline.UPDATE_PIECE_NUMBER(), 0)
                info.Set(pipeline.UPDATE_NUMBER_OF_PIECES(), 1)
                info.Set(pipeline.UPDATE_NUMBER_OF_GHOST_LEVELS(), 0)
                if info.Has(pipeline.WHOLE_EXTENT()):
                    extent = list(info.Get(pipeline.WHOLE_EXTENT()))
                    if port == 3:
                        extent[1::2] = extent[0::2]
                    info.Set(pipeline.UPDATE_EXTENT(), extent, 6)
        return 1

    def RequestData(self, request, inInfo, outInfo):
        """Computes the output."""
        info = outInfo.GetInformationObject(0)
        output = vtkDataObject.GetData(info)
        output.Initialize()

        def deform():
            time = self._check_time(info, inInfo)
            self._deform(output)
            request = vtkStreamingDemandDrivenPipeline.UPDATE_TIME_STEP()
            # Without times, VTK does not execute the filter for another time.
            if info.Has(request) and any(info.Has(key) for key in _TIMES):
                time = info.Get(request)
            if time is not None:
                output.GetInformation().Set(vtkDataObject.DATA_TIME_STEP(), time)

        return self._guard(deform)

    def _guard(self, work):
        try:
            work()
        except BaseException as error:  # pylint: disable=broad-except
            # VTK does not propagate exceptions: Update() raises the error again.
            text = "The execution was aborted." if isinstance(error, KeyboardInterrupt) else error
            vtkOutputWindow.GetInstance().DisplayErrorText(f"ERROR: DeformVolume: {text}\n")
            output = self.GetOutputDataObject(0)
            if output is not None:
                output.Initialize()
            self._counts = {}
            self._error = error if self._is_updating else None
            return 0
        return 1

    def _check_time(self, info, inInfo):
        """Raises an error if the data of an input are not of the requested time. Returns the first time of data, or
        None."""
        steps = vtkStreamingDemandDrivenPipeline.TIME_STEPS()
        request = vtkStreamingDemandDrivenPipeline.UPDATE_TIME_STEP()
        found = None
        for port in range(3):
            data = self._input(port)
            if data is None or not data.GetInformation().Has(vtkDataObject.DATA_TIME_STEP()):
                continue
            source = inInfo[port].GetInformationObject(0)
            time = data.GetInformation().Get(vtkDataObject.DATA_TIME_STEP())
            found = time if found is None else found
            if info.Has(request) and source.Has(steps):
                wanted = info.Get(request)
                times = sorted(source.Get(steps))
                # Sources choose the time step before or after the request.
                before = max([step for step in times if step <= wanted], default=times[0])
                after = min([step for step in times if step >= wanted], default=times[-1])
                # Readers of one time step give the requested time to their data.
                if time != wanted and not before <= time <= after:
                    raise ValueError(
                        f"Time {wanted} was requested, but the data on port {port} are of time {time}. Update the "
                        f"source first: source.UpdateTimeStep({wanted}), then filter.Update()."
                    )
        return found

    def _input(self, port):
        return self.GetInputDataObject(port, 0) if self.GetNumberOfInputConnections(port) > 0 else None

    def _stamp_inputs(self):
        return [_stamp(*_find_blocks(self._input(port))) for port in (0, 1, 2)]

    def _announce(self, info):
        sources = []
        for port in (0, 1, 2):
            if self.GetNumberOfInputConnections(port) > 0:
                self._update_input(port)
                sources.append(self.GetInputInformation(port, 0))
        self._prepare()
        grid = self._deformer._find_output_grid()
        self._announced = bytes(grid)
        # VTK passes on the times of port 0 only. A filter without times is not executed for another time.
        steps, ends = [{time for source in sources if source.Has(key) for time in source.Get(key)} for key in _TIMES]
        ends |= steps
        for key, times in zip(_TIMES, (sorted(steps), [min(ends), max(ends)] if ends else [])):
            if times:
                info.Set(key, times, len(times))
            else:
                info.Remove(key)
        info.Set(vtkStreamingDemandDrivenPipeline.WHOLE_EXTENT(), grid.extent[:], 6)
        info.Set(vtkDataObject.ORIGIN(), grid.origin[:], 3)
        info.Set(vtkDataObject.SPACING(), grid.spacing[:], 3)
        info.Set(vtkDataObject.DIRECTION(), grid.direction[:], 9)

    def _update_input(self, port):
        connection = self.GetInputConnection(port, 0)
        if not connection.GetProducer().GetExecutive().Update(connection.GetIndex()):
            raise _native.Error(
                f"The input on port {port} cannot be updated: {connection.GetProducer().GetClassName()} failed."
            )

    def _prepare(self):
        """Passes changed inputs and properties to the deformer."""
        is_deformed = self._input(1) is not None
        if self._deformer is None or ("deformation" in self._stamps and not is_deformed):
            self._deformer = _deformer.Deformer(self._settings["Device"])
            self._stamps = {}
        self._prepare_volume(self._input(0))
        self._prepare_deformation(self._input(1), self._input(2))
        settings = self._settings
        mode = _OUTSIDE[settings["OutsideMode"]]
        self._deformer.set_outside(mode, settings["FadeDistance"] if mode == "keep" else 0.0)
        if self.GetNumberOfInputConnections(3) > 0:
            info = self.GetInputInformation(3, 0)
            keys = (vtkDataObject.ORIGIN(), vtkDataObject.SPACING(), vtkDataObject.DIRECTION())
            if all(info.Has(key) for key in keys):
                geometry = [info.Get(key) for key in keys]
            else:
                # A source that does not announce all may announce the origin and spacing of its input.
                self._update_input(3)
                image = self._input(3)
                geometry = [image.GetOrigin(), image.GetSpacing(), _direction(image)]
            extent = info.Get(vtkStreamingDemandDrivenPipeline.WHOLE_EXTENT())
            self._deformer._set_reference_grid(_deformer.make_grid(extent, *geometry))
        else:
            self._deformer.set_reference(None)
            self._deformer.set_output(_BOUNDS[settings["OutputBoundsMode"]])

    def _send(self, name, stamp, send):
        """Calls send() if the stamp differs from that of the last call that succeeded."""
        if self._stamps.get(name) == stamp:
            return
        try:
            send()
        except BaseException:
            # The deformer has a part of the new data, or none.
            self._deformer = None
            raise
        self._stamps[name] = stamp

    def _prepare_volume(self, image):
        if image is None:
            raise ValueError("There is no volume on port 0. Set it with SetInputConnection().")
        data = image.GetPointData()
        arrays = [array for array, _ in _name_arrays(data, _POINT_MASKS) if _is_numeric(array)]
        if not arrays:
            raise ValueError(
                "The volume on port 0 has no numeric point array. Connect a vtkImageData with point scalars."
                + _describe_arrays(image)
            )
        unknown = self._densities - {array.GetName() for array in arrays}
        if unknown:
            raise ValueError(
                f'The volume on port 0 has no numeric point array "{min(unknown)}", which AddDensityArray() names.'
                + _describe_arrays(image)
            )
        for number, array in enumerate(arrays):
            if array.GetName() and any(other.GetName() == array.GetName() for other in arrays[:number]):
                raise ValueError(f'Two arrays of the volume are named "{array.GetName()}". Rename one of them.')
            if array.GetName() in _GENERATED and self._settings[_GENERATED[array.GetName()]]:
                raise ValueError(
                    f'The volume on port 0 has a point array "{array.GetName()}", which is the name of an array that '
                    "the filter generates. Rename or remove it."
                )
        edits = [data.GetArray(name) for name in _POINT_MASKS]
        edits += [image.GetCellData().GetArray(name) for name in _CELL_MASKS]
        ids = (data.GetGlobalIds(), data.GetPedigreeIds())
        labels = [
            array.GetName() in self._categorical or any(array is other for other in ids)
            for array in arrays
        ]
        densities = [array.GetName() in self._densities for array in arrays]
        background = self._settings["BackgroundValue"]
        self._arrays = arrays

        def send():
            self._stamps.pop("deformation", None)
            shape = image.GetDimensions()[::-1]
            views = [numpy.ascontiguousarray(_view(array, shape)) for array in arrays]
            # NaN becomes 0 in integers, as in the C++ class.
            values = [0.0 if view.dtype.kind in "iu" and background != background else background for view in views]
            self._deformer._set_volume_grid(_grid_of(image), views, labels, values, densities)
            self._prepare_masks(shape, *edits)

        self._send("volume", (_stamp(image, *arrays, *edits), labels, densities, background), send)

    def _prepare_masks(self, shape, ghosts, valid, boundary, cut_distances, active, cut, cell_ghosts):
        cells = tuple(number - 1 for number in shape)

        def view(array, over):
            return None if array is None else _view(array, over)

        if cell_ghosts is not None:
            # Switch hidden cells off, except those that only an edit hides (_HIDDEN_BY_EDIT).
            both = vtkDataSetAttributes.HIDDENCELL | _HIDDEN_BY_EDIT
            hidden = (_view(cell_ghosts, cells) & both) == vtkDataSetAttributes.HIDDENCELL
            tetrahedra = numpy.full(cells, _ALL_TETRAHEDRA, numpy.uint8) if active is None else _view(active, cells)
            tetrahedra = numpy.where(hidden, 0, tetrahedra)
        else:
            tetrahedra = view(active, cells)
        blanked = None if ghosts is None else (_view(ghosts, shape) & _NO_SOURCE) != 0
        if valid is not None:
            invalid = _view(valid, shape) == 0
            blanked = invalid if blanked is None else blanked | invalid
        self._deformer._set_masks(
            blanked=blanked,
            active=tetrahedra,
            boundary=view(boundary, shape),
            cut=view(cut, cells),
            cut_distances=view(cut_distances, shape),
        )

    def _find_vectors(self, data):
        info = self.GetInputArrayInformation(0)
        key = vtkDataObject.FIELD_ASSOCIATION()
        points_only = vtkDataObject.FIELD_ASSOCIATION_POINTS, vtkDataObject.FIELD_ASSOCIATION_POINTS_THEN_CELLS
        if info.Has(key) and info.Get(key) not in points_only:
            raise ValueError(
                "The displacements are not chosen among the arrays of points. Choose an array with "
                "SetInputArrayToProcess() and FIELD_ASSOCIATION_POINTS."
            )
        name = info.Get(vtkDataObject.FIELD_NAME()) if info.Has(vtkDataObject.FIELD_NAME()) else None
        points = data.GetPointData()
        if name:
            array = points.GetArray(name)
            if array is None:
                raise ValueError(
                    f'The deformation on port 1 has no numeric point array "{name}". Choose one with '
                    "SetInputArrayToProcess(), or with vectors=NAME of deformvolume.pyvista." + _describe_arrays(data)
                )
        else:
            array = points.GetVectors()
            found = [points.GetArray(i) for i in range(points.GetNumberOfArrays())]
            found = [one for one in found if one is not None and one.GetNumberOfComponents() == 3]
            normals = points.GetNormals()
            usable = [
                one
                for one in found
                if one is not normals and one.GetName() != "Normals" and one.GetDataType() != VTK_UNSIGNED_CHAR
            ]
            if array is None and len(usable) == 1:
                array = usable[0]
            if array is None:
                names = ", ".join(f'"{one.GetName()}"' for one in found) or "none"
                raise ValueError(
                    "The deformation on port 1 has no active vectors. Its point arrays of three components are: "
                    f"{names}. Normals, and colors of unsigned char, are only used if they are chosen. Set active "
                    "vectors, or choose an array with SetInputArrayToProcess(), or with vectors=NAME of "
                    "deformvolume.pyvista." + _describe_cell_arrays(data)
                )
        if array.GetNumberOfComponents() != 3:
            raise ValueError(
                f'The array "{array.GetName()}" on port 1 has {array.GetNumberOfComponents()} components. '
                "Displacements must have 3."
            )
        return array

    def _prepare_deformation(self, data, rest):
        if data is None:
            return
        if isinstance(data, vtkImageData):
            self._prepare_field(data, rest)
        else:
            self._prepare_mesh(data, rest)

    def _deform_points(self, points, inverse, outside, fade_distance):
        """Does the same as deformvolume.deform_points(), with the deformation on ports 1 and 2."""
        self._deformer = _deformer.Deformer()
        self._stamps = {}
        self._prepare_deformation(self._input(1), self._input(2))
        self._deformer.set_outside(outside, fade_distance)
        return self._deformer.deform_points(points, inverse=inverse)

    def _prepare_field(self, data, rest):
        if rest is not None:
            raise ValueError(
                "Port 1 has a displacement field, which cannot be used with a mesh at rest. Disconnect port 2."
            )
        array = self._find_vectors(data)
        ghosts = data.GetPointData().GetArray("vtkGhostType")
        valid = data.GetPointData().GetArray(_VALID)
        inverse = self._settings["FieldIsInverse"]

        def send():
            hidden = _find_hidden_points(data)
            vectors = _view(array, data.GetDimensions()[::-1])
            if vectors.dtype not in (numpy.float32, numpy.float64):
                vectors = vectors.astype(numpy.float64)
            self._deformer._set_field_grid(_grid_of(data), numpy.ascontiguousarray(vectors), inverse, hidden)

        self._send("deformation", (_stamp(data, array, ghosts, valid), inverse), send)

    def _convert(self, grid, port):
        """Returns other grids, and the blocks of a composite dataset, as vtkUnstructuredGrid, and a vtkUnstructuredGrid
        as it is."""
        if isinstance(grid, vtkUnstructuredGrid):
            return grid
        blocks = _find_blocks(grid)
        types = vtkUnstructuredGrid, vtkStructuredGrid, vtkExplicitStructuredGrid, vtkRectilinearGrid
        for block in blocks:
            if not isinstance(block, types):
                of_blocks = "" if block is grid else f", as a block of a {grid.GetClassName()}"
                raise TypeError(
                    f"Port {port} has a {block.GetClassName()}{of_blocks}. Give "
                    f"{', '.join(one.__name__ for one in types)}, a composite dataset of these or, on port 1, one "
                    "vtkImageData, such as blocks[0] of pyvista."
                )
        stamp = _stamp(*blocks)
        if self._converters.get(port, ())[:1] != (stamp,):
            converter = vtkAppendFilter()
            converter.SetOutputPointsPrecision(vtkAlgorithm.DOUBLE_PRECISION)
            for block in blocks:
                converter.AddInputDataObject(block)
            if blocks:
                converter.Update()
            self._converters[port] = stamp, converter.GetOutput()
        return self._converters[port][1]

    def _prepare_mesh(self, data, rest):
        deformed = self._convert(data, 1)
        mesh = deformed if rest is None else self._convert(rest, 2)
        if mesh.GetPoints() is None or mesh.GetNumberOfCells() == 0:
            raise ValueError(f"The mesh on port {1 if rest is None else 2} has no cells.")
        points = vtk_to_numpy(mesh.GetPoints().GetData())

        def send_mesh():
            self._stamps.pop("displacements", None)
            types = numpy.ascontiguousarray(vtk_to_numpy(_cell_types(mesh)))
            cells = mesh.GetCells()
            connectivity = numpy.ascontiguousarray(vtk_to_numpy(cells.GetConnectivityArray()), dtype=numpy.int64)
            offsets = numpy.ascontiguousarray(vtk_to_numpy(cells.GetOffsetsArray()), dtype=numpy.int64)
            used = _find_used_cells(mesh, connectivity, offsets)
            if used is not None:
                if not used.any():
                    raise ValueError(
                        "All cells of the mesh are hidden, duplicate, or have a hidden point (vtkGhostType, "
                        "vtkValidPointMask)."
                    )
                sizes = numpy.diff(offsets)
                types, connectivity = types[used], connectivity[numpy.repeat(used, sizes)]
                offsets = numpy.concatenate(([0], numpy.cumsum(sizes[used])))
            self._deformer._set_mesh_arrays(
                points,
                connectivity,
                types,
                offsets,
                degrees=_find_degrees(mesh, used),
                faces=_find_faces(mesh, types, used),
            )

        self._send("deformation", (_shape_stamp(mesh), "mesh"), send_mesh)
        if rest is None:
            array = self._find_vectors(deformed if isinstance(data, vtkCompositeDataSet) else data)
            self._send(
                "displacements", _stamp(array, data), lambda: self._deformer.set_displacements(vtk_to_numpy(array))
            )
            return
        if deformed.GetNumberOfPoints() != len(points):
            raise ValueError(
                f"The mesh on port 1 has {deformed.GetNumberOfPoints()} points, but the mesh at rest on port 2 has "
                f"{len(points)}. Both must have the same points."
            )

        def send_difference():
            moved = vtk_to_numpy(deformed.GetPoints().GetData()).astype(numpy.float64)
            self._deformer.set_displacements(moved - points)

        stamp = _stamp(deformed.GetPoints(), deformed, mesh.GetPoints(), mesh)
        self._send("displacements", stamp, send_difference)

    def _find_warnings(self, volume):
        """Returns the warnings of arrays of the volume and of the reference image, as those of the C++ class."""
        points, cells = volume.GetPointData(), volume.GetCellData()
        warnings = set()
        if self._input(3) is not None and self._settings["OutputBoundsMode"] != self.DEFORMED_BOUNDS:
            warnings.add(
                "The output has the grid of the reference image on port 3. OutputBoundsMode has no effect. Disconnect "
                "the reference image to use it."
            )

        def warn(text, names, advice=""):
            if names:
                warnings.add(f"{text}: {', '.join(names)}.{advice}")

        warn(
            "Cell arrays of the volume are not resampled",
            [name for _, name in _name_arrays(cells, _CELL_MASKS)],
            " Convert them to point arrays to resample them.",
        )
        warn(
            "These point arrays of the volume are left out, because their types cannot be resampled",
            [
                f"{name} ({array.GetDataTypeAsString()})"
                for array, name in _name_arrays(points, _POINT_MASKS)
                if not _is_numeric(array)
            ],
        )
        warn(
            "The volume has no point arrays with these names of categorical arrays",
            sorted(self._categorical - {array.GetName() for array in self._arrays}),
        )
        for kind in ("vectors", "normals", "tensors"):
            array = getattr(points, f"Get{kind.capitalize()}")()
            if array is not None:
                warnings.add(
                    f'The active {kind} "{array.GetName() or ""}" of the volume are interpolated component by '
                    "component, and not rotated with the deformation. If their directions matter, rotate them "
                    "afterwards."
                )
        return warnings

    def _warn(self, text):
        if "pyvista" in sys.modules:
            # pyvista replaces VTK's window by one that shows errors only.
            _deformer._warn(text)
        else:
            vtkOutputWindow.GetInstance().DisplayWarningText(f"Warning: DeformVolume: {text}\n")

    def _deform(self, output):
        self._prepare()
        self._inputs = self._stamp_inputs()
        grid = self._deformer._find_output_grid()
        if bytes(grid) != self._announced:
            self.Modified()
            raise ValueError(
                "The output has another grid at this time. Set OutputBoundsMode to VOLUME_BOUNDS, connect a reference "
                "image, or update again."
            )
        output.SetExtent(grid.extent[:])
        output.SetOrigin(grid.origin[:])
        output.SetSpacing(grid.spacing[:])
        output.SetDirectionMatrix(grid.direction[:])
        shape = output.GetDimensions()[::-1]
        volume = self._input(0)

        def add(name, dtype, components=1, vtk_type=None):
            array = vtkDataArray.CreateDataArray(vtk_type or get_vtk_array_type(dtype))
            if name:
                array.SetName(name)
            array.SetNumberOfComponents(components)
            array.SetNumberOfTuples(shape[0] * shape[1] * shape[2])
            output.GetPointData().AddArray(array)
            return _view(array, shape)

        data = volume.GetPointData()
        outputs = []
        for source in self._arrays:
            kind = source.GetDataType()
            kind = VTK_FLOAT if source.GetName() in self._densities and kind != VTK_DOUBLE else kind
            outputs.append(add(source.GetName(), None, source.GetNumberOfComponents(), kind))
            array = output.GetPointData().GetAbstractArray(len(outputs) - 1)
            array.CopyComponentNames(source)
            array.SetLookupTable(source.GetLookupTable())
            if source.HasInformation():
                array.CopyInformation(source.GetInformation(), 1)
        mask = add("vtkValidPointMask", None, vtk_type=VTK_CHAR)
        extra = {}
        if self._settings["GenerateRestPositions"]:
            extra["rest_positions"] = add("RestPosition", numpy.float32, 3)
        if self._settings["GenerateJacobian"]:
            extra["jacobian"] = add("Jacobian", numpy.float32)
        if self._settings["GenerateFoldCount"]:
            extra["fold_count"] = add("FoldCount", numpy.uint32)
            extra["fold_count"][...] = 0
        report = self._deformer._run(
            outputs,
            mask,
            interpolation=_INTERPOLATION[self._settings["Interpolation"]],
            extra=extra,
            extra_background=self._settings["BackgroundValue"],
            progress=self._report_progress,
        )
        for role in range(vtkDataSetAttributes.NUM_ATTRIBUTES):
            array = data.GetAbstractAttribute(role)
            for number, one in enumerate(self._arrays):
                if one is array:
                    output.GetPointData().SetActiveAttribute(number, role)
        output.GetFieldData().PassData(volume.GetFieldData())
        self._counts = report.counts()
        self._device = report.device.decode("utf-8", "replace")
        warnings = self._find_warnings(volume)
        if report.warnings:
            warnings.add(report.warnings.decode("utf-8", "replace"))
        texts = sorted(warnings - self._warned)
        self._warned = warnings
        for text in texts:
            self._warn(text)

    def _report_progress(self, fraction):
        self.UpdateProgress(fraction)
        return not self.GetAbortExecute()
