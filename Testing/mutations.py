#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Changes constants and lines that correctness depends on, one at a time, and runs the tests that must fail.

    python3 Testing/mutations.py [NAME...]

Without names all mutations are run. --list prints their names. --check lists mutations whose text does not exist
once. The sources are copied to build/mutations, so the working tree does not change. First the tests must pass
without a mutation. Each mutation replaces one text in one file; the tests are built, and those of the mutation are
run. Prints a table with the change and the first test that failed. Returns 1 if no test failed for a mutation.
CONTRIBUTING.md says when to add a mutation.
"""
import argparse
import os
import pathlib
import re
import subprocess
import sys

SOURCE = pathlib.Path(__file__).resolve().parent.parent
WORK = SOURCE / "build" / "mutations"
COPY = WORK / "source"
BUILD = WORK / "build"
# The build against ParaView's VTK, with the plugin, whose tests CTest starts.
PLUGIN_BUILD = WORK / "plugin-build"
SKIPPED = 125
# CTest fails a test of the VTK classes if its output matches this expression.
ERROR = re.compile(r"(^|\n)ERROR: |(^|\n|[|] *)ERR[|]")

NARROW = ("TestNarrowDecisions", "*")
MASKS = ("TestIncremental", "IncrementalMasks*")
ALONG = ("TestPiecewise", "*AlongSomeAxes*")
MISSING = ("TestResampling", "*_Uncut")
FOLDS = ("TestIncremental,TestEdits", "*IncrementalFolds*:*Edits*-*ByCell")
BY_CELL = ("TestIncremental", "*Folds*ByCell")
ALIGNED = ("TestEdits", "-*ByCell")
OWN_MEMORY = ("TestIncrementalGraphics@gpu-like", "*")
MEMORY = ("TestHostMemory", "*")
LARGE = ("TestLargeCells", "-*Time*")
FAULTS = ("TestFaults", "*")
RASTER_GRAPHICS = ("TestMeshRasterization@gpu-like", "-*IdentityAndWholeShifts*:*ValuesOfAllTypes*")
DEVICE_OUTPUT = ("TestDeviceOutput@gpu-like", "*")
GRAPHICS = ("TestGraphicsDevice@gpu-like-no-double", "*")
STAGED = ("TestStagedCopies@gpu-like", "Staged.*")
CUBIC = ("TestCubic", "*")
CUTTING = ("TestCutting", "*")
SMOOTH = ("TestSmoothCuts,TestResampling", "SmoothCuts*:*_CutAtRandom:*_Opened:*_Overlapping")
EDITS = ("TestMaskEditor", "*")
SPLIT = ("TestMeshSplit", "*")
SPLIT_FACES = ("TestSplitFaces", "*")
CROSSINGS = ("TestSheetCrossings", "*")
CUT_PARTS = ("TestIncrementalCuts", "IncrementalCuts.*")
CARVING = ("TestCarving", "*")
CHAINMAIL = ("TestChainMail", "*")
RELAXATION = ("TestChainMailRelaxation", "*")
SEQUENCES = ("TestChainMailSequences", "*")
VECTORS = ("TestDeviceVectors", "*")
VECTORS_GRAPHICS = ("TestDeviceVectors,TestDeviceVectorsGraphics@gpu-like", "*")
ELEMENTS = ("TestElementMechanics", "*")
SPRINGS = ("TestMassSpring", "*")
SPRINGS_AT_REST = ("TestMassSpringStatics", "*")
ABORTS = ("TestElasticAborts", "*")

FINITE_ELEMENTS = ("TestFiniteElements", "*")
BEAMS = ("TestFiniteElementBeams", "*")
CONDITIONS = ("TestElementConditions", "*")
DEFORMED_CUTTING = ("TestDeformedCutting", "*")
LISTS = ("TestTetrahedronLists", "*")
BOUNDARY = ("TestMeshBoundary", "*")
PROPERTIES = "ParaView.TestProperties"
PIPELINES = "Fuzz.Pipelines"

# Tests of the VTK classes that open a window.
WITH_WINDOW = ("TestDeformVolumeInteractorStyle",)

# name: (file, text, replacement, tests). A test of the engine is a pair of its sources, with the kind of device behind
# @, and a filter of GoogleTest. A test of the VTK classes or of the plugin is its name in CTest.
MUTATIONS = {
    "filter-upright": ("Kernels/Resampling/PacketWeights.cl", "(FLOATS)(6.5e-6f)", "(FLOATS)(6.5e-8f)", [NARROW]),
    "vertex-shift": ("Kernels/Resampling/PacketCoverage.cl",
                     "const int shift = (high & 1) | (high >> 2 & 1) << 1 | (high >> 1 & 1) << 2;",
                     "const int shift = (high & 1) | (high >> 1 & 1) << 1 | (high >> 2 & 1) << 2;",
                     [MISSING]),
    "vertex-edge": ("Kernels/Resampling/PacketCoverage.cl", "1 << (vertex ^ 1)", "1 << (vertex ^ 2)",
                    [MISSING]),
    "mirrored-upright": ("Kernels/SamplingMesh/KernelParameters.h", " + z + p->IsMirrored) & 1;", " + z) & 1;",
                         [("TestOutputMaps", "OutputMaps.MirrorImagesHaveTheSameValues")]),
    "rest-fractions": ("Kernels/Resampling/BrickMapping.cl", "(ry.Fraction[axis] + rz.Fraction[axis]) * STEP",
                       "ry.Fraction[axis] * STEP", [("TestOutputMaps", "OutputMaps.AllPartsHaveTheSameBits")]),
    "special-groups": ("Kernels/Resampling/BrickResampling.cl", "~LaneBits(special)",
                       "LaneBits(special) ? 0u : ~0u", [("TestElementTypes", "*NotANumber*")]),
    "edge-end": ("Kernels/Resampling/PacketResampling.cl", "(x >= FROM(0))", "(x > FROM(0))", [ALONG]),
    "edge-end-bent": ("Kernels/Resampling/PacketResampling.cl", " & ~endsY & ~endsZ);", ");", [ALONG]),
    "edge-side": ("Kernels/Resampling/PacketResampling.cl", "const INTS lowestZ = alongZ & lowX & lowY;",
                  "const INTS lowestZ = alongZ & lowX;", [ALONG]),
    "base-counts": ("Kernels/ActiveTetrahedra/MaskEditor.cxx",
                    "this->NumberOfSwitchedOff -= CountBits(this->Base[cell] ^ this->Mask[cell]);", "",
                    [("TestMaskEditor", "*")]),
    "filter-bent": ("Kernels/Resampling/PacketWeights.cl", "(FLOATS)(3.2e-5f)", "(FLOATS)(3.2e-7f)", [NARROW]),
    "mask-halo": ("Kernels/ChangeTracking/ChangeTrackerChanges.cxx", "MaskHalo = 1;", "MaskHalo = 0;", [MASKS]),
    "old-winners": ("Kernels/Output/OutputWinners.cxx",
                    "    FillPatches(launcher, this->Keys, ElementBytes::Of(std::numeric_limits<cl_uint>::max()),\n"
                    "      this->KeySize / sizeof(cl_uint), list, patches.size(), parameters);\n", "", [FOLDS]),
    "counts-of-cuboids": ("Kernels/Resampling/Resampling.cl", "AddCounts(&output, section + span,",
                          "AddCounts(&output, section,", [BY_CELL]),
    "output-elsewhere": ("Kernels/Output/OutputMemory.cxx",
                         "deformvolume::GetMemory(element.Buffer) == voxels * element.TupleSize;", "true;", [ALIGNED]),
    "patches-left": ("Kernels/Output/OutputSlab.cxx", "if (!part.Patches.empty() && !onHost)", "if (false)",
                     [OWN_MEMORY]),
    "contested-twice": ("Kernels/Output/VoxelWinners.cl", "      return found == key;\n    }\n    const KEY seen",
                        "      return key == (found & ~CONTESTED);\n    }\n    const KEY seen", [FOLDS]),
    "winners-not-awaited": ("Kernels/Resampling/ExactResampler.cxx",
                            "this->Launcher.GetQueue().finish(); // the output is read in another queue", "", [FOLDS]),
    "clip": ("Kernels/Resampling/Resampling.cl", "CLIP_TOLERANCE (1.0f / 64.0f)", "CLIP_TOLERANCE 0.0f", [LARGE]),
    "cubic-interior": ("Kernels/Resampling/Resampling.cl", "if (cell->State.Interior != 255)", "if (!cell->State.Interior)",
        [CUBIC]),
    "cubic-boundary": ("Kernels/Resampling/Resampling.cl", "& DEFORMVOLUME_CELL_AT_BOUNDARY)", "& DEFORMVOLUME_CELL_CROSSED)",
        [CUBIC]),
    "cubic-cut": ("Kernels/Resampling/Resampling.cl", "for (int i = 0; i < 27; ++i)", "for (int i = 13; i < 14; ++i)",
        [CUBIC]),
    "cubic-last": ("Kernels/Incremental/IncrementalOutput.cxx", "this->LastInterpolation == request.Interpolation",
        "true", [MASKS]),
    "far-integers": ("Kernels/Resampling/SampleStoring.cl",
                     "const TYPE first = SOURCE[s->Sources[s->Nearest] * COMPONENTS + c];",
                     "const TYPE first = SOURCE[s->Sources[s->Only >= 0 ? s->Only : 0] * COMPONENTS + c];",
                     ["Kernels.TestElementTypes"]),
    "cubic-axes": ("Kernels/Resampling/SampleStoring.cl", "axis == 0 ? 0 : 3 - axis", "axis", [CUBIC]),
    "launch-end": ("Kernels/Resampling/Resampling.cl", "z <= p.LayersEnd + 1", "z <= p.LayersEnd", [MEMORY]),
    "launch-begin": ("Kernels/Resampling/Resampling.cl", "z >= max(p.LayersBegin - 1, 0)", "z >= p.LayersBegin",
                     [MEMORY]),
    "failed-read": ("Kernels/OpenCL/HostMemory.cxx", "return status < 0 ? status : error;",
                    "return error > 0 ? status : CL_SUCCESS;", [FAULTS]),
    "failed-write": ("Kernels/OpenCL/DeviceVectors.cxx", "  writes.Check();\n", "", [STAGED]),
    "staged-error": ("Kernels/OpenCL/StagedCopies.cxx", "error = error == CL_SUCCESS ? its : error;",
                     "static_cast<void>(its);", [STAGED]),
    "staged-plane": ("Kernels/OpenCL/StagedCopies.cxx", "size[2] > 1 || there.Origin[2] > 0 ? there.Plane : 0;",
                     "size[2] > 1 ? there.Plane : 0;", [STAGED]),
    "unread-overwritten": ("Kernels/Deformer/VolumeDeformerInternals.cxx",
                           "  this->BringOutput(); // the next output uses the same memory\n", "", [DEVICE_OUTPUT]),
    "unread-released": ("Kernels/Deformer/VolumeDeformerInternals.h",
                        "      this->All->BringOutput(); // otherwise it would keep device memory\n", "",
                        [DEVICE_OUTPUT]),
    "unread-missing": ("Kernels/Incremental/IncrementalOutput.cxx", "change != this->LastChanges.end(); ++change)",
                       "change == first; ++change)", [DEVICE_OUTPUT]),
    "unread-held": ("Kernels/Incremental/IncrementalOutput.cxx", "return this->Changes.GetOutputExtent();",
                    "return this->LastChanges.back().Changed;", [DEVICE_OUTPUT]),
    "unread-covered": ("Kernels/Output/OutputClearing.cl", "  for (size_t i = 0; i < ROWS_OF_PATCH; ++i)\n",
                       "  for (size_t i = 1; i < ROWS_OF_PATCH; ++i)\n", [DEVICE_OUTPUT]),
    "memory-twice": ("Kernels/OpenCL/MemoryBudget.cxx", "std::min(all, system) : all;",
                     "std::min(all, system) : all + this->CountHeld();", [GRAPHICS]),
    "arrays-half-set": ("Kernels/DeviceVolume/DeviceArrays.cxx",
                        "this->Described.clear(); // no arrays are set after an exception", "", [FAULTS]),
    "pressed-flat": ("Kernels/Displacements/FieldFolds.cxx", "LargestChange = 0.999F;", "LargestChange = 1.1F;", [("TestInverseField", "*")]),
    "links-half-set": ("Kernels/DeviceVolume/DeviceMapping.cxx", "this->WithLinks = false;", "this->WithLinks = true;",
                       [FAULTS]),
    "far-output": ("Kernels/Output/OutputSlab.cxx", "farthest = 1 << 22;", "farthest = 1 << 28;",
                   [("TestUse", "DeformerUse.OutputsFarAway")]),
    "null-group": ("Kernels/Output/OutputFilling.cxx",
                   "kernel, cl::NDRange((items + group - 1) / group * group), cl::NDRange(group));",
                   "kernel, cl::NDRange(items), cl::NullRange);", [GRAPHICS]),
    "far-vertices": ("Kernels/Resampling/PacketCandidates.cl", "TO_INTS(Min((high) + toEnd, (float)(size)))",
                     "min(TO_INTS((high) + toEnd), (INTS)(size))", [("TestFolded", "*AtTheEdge*")]),
    "raster-last": ("Kernels/Rasterization/MeshRasterization.cl", "begin < listed; begin +=", "begin + DEFORMVOLUME_TILE_SHARED <= listed; begin +=",
                    [RASTER_GRAPHICS]),
    "raster-rows": ("Kernels/Rasterization/MeshRasterization.cl", "rows |= ofPlane", "rows = ofPlane",
                    [RASTER_GRAPHICS]),
    "columns-left": ("Kernels/Resampling/ColumnResampling.cl", "entry >> DEFERRED_BITS == DEFERRED_INT32, &output", "1, &output",
                     [("TestColumns", "*")]),
    "columns-again": ("Kernels/Resampling/ColumnResampling.cl", "step == CELL_DONE ? DEFERRED_INT32 : step)",
                      "DEFERRED_INT32)", [("TestColumns", "*")]),
    "columns-whole": ("Kernels/Resampling/ColumnResampling.cl", "(any & FLAG_BORDER && !(lowest & FLAG_WHOLE))", "0",
                      [MISSING]),
    "columns-launch": ("Kernels/Resampling/ColumnCells.cl", "bricks[p->ListBegin + cell / CELLS_OF_BRICK]",
                       "bricks[cell / CELLS_OF_BRICK]", [("TestColumns", "*MoreBricks*")]),
    "float-integers": ("Kernels/SamplingMesh/ArrayText.cxx", "GetElementSize(arrays[i].Type) >= 4)",
                       "GetElementSize(arrays[i].Type) >= 16)", [GRAPHICS]),
    "local-memory": ("Kernels/Output/ResamplingProgram.cxx", "return GetBrickMemory(context, hasTurnedAxes, 0) <=",
                     "return true || GetBrickMemory(context, hasTurnedAxes, 0) <=", [FAULTS]),
    "chunks-overlap": ("Kernels/DeviceVolume/DeviceArrays.cxx",
                       "this->ChunkInPlace->Arrays[i] = cl::Buffer();", "", [FAULTS]),
    "field-overlaps": ("Kernels/DeviceVolume/DeviceArrays.cxx", "!field.Overlaps(array.Data, bytes) ||", "true ||", [FAULTS]),
    "fused-field": ("Kernels/Displacements/FieldPoints.cl",
                    "#define MIX(a, b, t) MULTIPLY_ADD((float4)(t), (b) - (a), a)",
                    "#define MIX(a, b, t) ((a) + (t) * ((b) - (a)))", [("TestContraction", "*")]),
    "lists-order": ("Kernels/Binning/EntryLists.cl",
                    "before += word < item / 32 ? popcount(mask[word]) : 0;", "", [LISTS]),
    "lists-inverted": ("Kernels/Binning/EntryLists.cl", "2 * tile + IsInverted(box.y);", "2 * tile;", [LISTS]),
    "lists-box": ("Kernels/Binning/TetrahedronBinning.cl", "#define TILES_BITS_X 8", "#define TILES_BITS_X 7",
                  [LISTS]),
    "boundary-neighbors": ("Kernels/DeformationMesh/BoundaryFinder.cxx", "this->Near.Add(i, j, k);",
                            "i == x && j == y && k == z ? this->Near.Add(i, j, k) : (void)0;", [BOUNDARY]),
    "boundary-places": ("Kernels/DeformationMesh/BoundaryFaces.cxx", "return places[static_cast<std::size_t>(node)];",
                        "return places.empty() ? 0 : node;", [BOUNDARY]),
    "boundary-border": ("Kernels/DeformationMesh/BoundaryFinder.h", "BorderTolerance = 1.0 / 512.0;",
                        "BorderTolerance = -1.0 / 512.0;", [BOUNDARY]),
    "boundary-large": ("Kernels/DeformationMesh/BoundaryFinder.cxx", "LargestPiece = 128.0;", "LargestPiece = 1e9;", [BOUNDARY]),
    "boundary-flag": ("Kernels/SamplingMesh/VertexState.cl", "!BeginsCrossed(state, active, x, y, z, p)", "1", [BOUNDARY]),
    "boundary-surrounded": ("Kernels/SamplingMesh/VertexState.cl",
                            "|| IsComplete(state, cell, i, j, k, p);", "|| 1;", [BOUNDARY]),
    "boundary-points": ("Kernels/DeviceVolume/BrickPoints.cxx",
                        "std::for_each(mesh.Boundary[brick].begin(), mesh.Boundary[brick].end(), add);", "", [BOUNDARY]),
    "boundary-fields": ("Kernels/DeviceVolume/BrickPoints.cxx", "Include(box, boundary[brick]);", ";", [BOUNDARY]),
    "boundary-patches": ("Kernels/Resampling/BoundaryCells.cxx", "this->CoveredInPatches[patch] = 0;", "", [BOUNDARY]),
    "boundary-upright": ("Kernels/Resampling/BoundaryCells.cl", "(ulong)isInverted << 63 | ", "", [BOUNDARY]),
    "boundary-chunks": ("Kernels/Resampling/BoundaryCells.cxx", "std::vector<int>{ 1, 2 }", "std::vector<int>{ 3 }",
                        [BOUNDARY]),
    "boundary-blanked": ("Kernels/Resampling/BoundaryCells.cl", "if (r->HasBlanked && masks->Blanked[voxel])", "if (false)",
                         [BOUNDARY]),
    "boundary-active": ("Kernels/Resampling/BoundaryCells.cl", "if ((active >> t & 1) && ", "if (", [BOUNDARY]),
    "edits-forget": ("Kernels/ActiveTetrahedra/MaskEditor.cxx", "this->Hits.Forget(edit.Set.Bricks);", "", [EDITS]),
    "edits-crossings": ("Kernels/ActiveTetrahedra/SmoothCrossings.cxx", "this->Cells.Forget(edit.Bricks);", "", [CROSSINGS]),
    "cut-above": ("Kernels/Cutting/TriangleCrossing.h", "return (sign != 0 ? sign : this->NormalSign) > 0;",
                  "return sign > 0;", [CUTTING]),
    "cut-face": ("Kernels/Cutting/TriangleCrossing.cxx", "sign != 0 ? sign : -movement;",
                 "sign != 0 ? sign : movement;", [CUTTING]),
    "cut-edge": ("Kernels/Cutting/TriangleCrossing.cxx", "sign != 0 ? sign : FindSign(Cross(along, b - a));",
                 "sign != 0 ? sign : -FindSign(Cross(along, b - a));", [CUTTING]),
    "cut-box": ("Kernels/Cutting/SheetCut.cxx", "p[axis] < box.Min[axis] ? 1U", "p[axis] <= box.Min[axis] ? 1U",
                [CUTTING]),
    "cut-length": ("Kernels/Cutting/Sheet.h", "std::int64_t{ 1 } << 17", "std::int64_t{ 1 } << 24", [CUTTING]),
    "cut-side": ("Kernels/Resampling/Resampling.cl",
                 "(WeighDistances(cell->Cut.Distances, t, weights) < 0) != cell->Side", "0", [SMOOTH]),
    "cut-gap": ("Kernels/SamplingMesh/KernelParameters.h", "DEFORMVOLUME_CLOSED_GAP 64",
                "DEFORMVOLUME_CLOSED_GAP 0", [SMOOTH]),
    "cut-border": ("Kernels/Resampling/CellCoverage.cl",
                   "hasPositions = hasPositions && ViewTetrahedron(mesh, &cut, t, side, v);", "", [SMOOTH]),
    "cut-settled": ("Kernels/Resampling/PacketCandidates.cl", "!isDivided && IsSettled(", "IsSettled(",
                    [("TestSmoothCuts", "*CopiesBeyond*")]),
    "cut-joined": ("Kernels/DeviceVolume/CutPositions.cl", "if (apart & joined)", "if (false)", [SMOOTH]),
    "cut-multiple": ("Kernels/ActiveTetrahedra/SmoothCrossings.cxx", "!isMultiple && isDivision && isClear",
                     "isDivision && isClear", [CROSSINGS]),
    "cut-copies": ("Kernels/ChangeTracking/ChangeTrackerBoxes.cxx", "      low -= difference;\n      high += difference;\n",
                   "", [CUT_PARTS]),
    "cut-halo": ("Kernels/SamplingMesh/BrickGrid.h", "HaloOfCuts = 2;", "HaloOfCuts = 1;", [CUT_PARTS]),
    "cut-stencils": ("Kernels/DeviceVolume/DeviceVolume.cxx", "this->States.Report(cut);", "", [CUT_PARTS]),
    "cut-kept": ("Kernels/DeviceVolume/CutPositions.cl", "= lastStencils[last];", "= (uint2)(0);", [CUT_PARTS]),
    "cut-unchanged": ("Filters/Arrays/VolumeArrays.cxx", "IsUnchanged(arrays, CutCells, last) &&", "!last.empty() ||",
                      ["Cxx.TestSmoothCut"]),
    "fem-history": ("Kernels/FiniteElements/TangentSolver.cxx", "  this->History.ForgetProducts();\n", "",
                    [FINITE_ELEMENTS]),
    "fem-tangent": ("Kernels/FiniteElements/EquilibriumSolver.cxx",
                    "if (before > 0.0 && residuals.Largest > leastGain * before)",
                    "if (before > 1e300 && residuals.Largest > leastGain * before)", [FINITE_ELEMENTS]),
    "split-reach": ("Kernels/Physics/SplitRegion.cxx", "0.25 * std::max(", "0.0 * std::max(", [SPLIT_FACES]),
    "split-near": ("Kernels/Physics/MeshSplit.cxx", "(region.IsNear(face / 4) || ", "(region.IsNear(face / 4) && ",
                   [SPLIT_FACES]),
    "split-before": ("Kernels/Physics/MeshSplit.cxx", "states[face] = states[next] = SplitBefore;", "", [SPLIT]),
    "carve-ray": ("Kernels/Cutting/SurfaceInterior.cxx", "along.z != 0 ? -GetSign(along.z) : GetSign(along.y);",
                  "along.z != 0 ? GetSign(along.z) : GetSign(along.y);", [CARVING]),
    "carve-plane": ("Kernels/Cutting/SurfaceInterior.cxx", "return height == -GetSign(this->Normal.x);",
                    "return height != GetSign(this->Normal.x);", [CARVING]),
    "chainmail-way": ("Kernels/ChainMail/ChainMailPropagation.cl", "(face & 1) ^ up", "(face & 1)", [CHAINMAIL]),
    "chainmail-pins": ("Kernels/ChainMail/ChainMailPropagation.cl", "DEFORMVOLUME_FIXED)) != 0) | pinned;",
                       "DEFORMVOLUME_FIXED)) != 0);", [SEQUENCES]),
    "chainmail-sweeps": ("Kernels/ChainMail/ChainMailPropagation.cl", "sweep <= VOXELS;", "sweep < 24;", [CHAINMAIL]),
    "chainmail-saved": ("Kernels/ChainMail/ChainMailSolver.cxx", "if (results[i] & DEFORMVOLUME_SAVED)", "if (false)",
                        [CHAINMAIL]),
    "chainmail-relax": ("Kernels/ChainMail/ChainMailRelaxation.cl",
                        "FindLimitsBeside(limits, m, n.Materials, face, over, under);",
                        "FindLimitsBeside(limits, m, n.Materials, face, under, over);", [RELAXATION]),
    "chainmail-weights": ("Kernels/ChainMail/ChainMailLimits.cxx", "std::max(ranges[kind], smallest)",
                          "std::max(ranges[0], smallest)", [RELAXATION]),
    "chainmail-copy": ("Kernels/ChainMail/ChainMailSolver.cxx",
                       "this->State.ReadOutput(changes);", "",
                       [("TestChainMailSequences@gpu-like-no-double", "*")]),
    "chainmail-changes": ("Kernels/ChainMail/ChainMailSolver.cxx",
                       "this->State.MarkChanges(report.Changes);", "", [VECTORS]),
    "log-begin": ("Kernels/Common/RangeLog.cxx", "this->Begin = this->Entries.front().Revision;", "", [VECTORS]),
    "vectors-turns": ("Kernels/Displacements/DisplacementSource.cxx",
                      "this->Converter.Forget();\n  this->SendNodes", "this->SendNodes", [VECTORS]),
    "vectors-good": ("Kernels/Displacements/VectorConversion.cl", "if (!all(fabs(moved) <= largest))",
                     "if (any(fabs(moved) > largest))", [VECTORS_GRAPHICS]),
    "vectors-portion": ("Kernels/Displacements/VectorConverter.cxx", "conversion.Launch(this->Portion, first, count);",
                        "conversion.Launch(this->Portion, 0, count);", [VECTORS_GRAPHICS]),
    "vectors-forget": ("Kernels/Displacements/VectorConverter.cxx", "  this->ForgetVectors();\n  const std::size_t most",
                       "  const std::size_t most", [VECTORS_GRAPHICS]),
    "vectors-scan": ("Kernels/Displacements/FieldChecker.cxx", "SumOfLanes(voxels.Faults + others.Faults)",
                     "SumOfLanes(voxels.Faults)", [("TestFieldChecker", "*")]),
    "vectors-factor": ("Kernels/DeformationMesh/DisplacementField.h", "constexpr std::uint64_t unit = 1 << 24;",
                       "constexpr std::uint64_t unit = 1 << 0;", [("TestContraction", "*")]),
    "fem-untangle": ("Kernels/FiniteElements/EquilibriumSolver.cxx", "if (state.Sums.Inverted > inverted)",
                     "if (false)", [FINITE_ELEMENTS]),
    "fem-sweeps": ("Kernels/Elements/SingularValues.h", "sweeps = 4;", "sweeps = 2;", [ELEMENTS]),
    "fem-inverted": ("Kernels/Elements/SingularValues.h", "result.Values[2] = Dot(U.Columns[2], b[2]);",
                     "result.Values[2] = Absolute(Dot(U.Columns[2], b[2]));", [ELEMENTS]),
    "fem-clamp": ("Kernels/Elements/ElementMechanics.h", "return Largest(MakeLanes(0.0), -value);",
                  "return MakeLanes(0.0) * value;", [ELEMENTS]),
    "fem-flat": ("Kernels/FiniteElements/FiniteElements.cxx", "component = IsFlat(result.Determinant) ?",
                 "component = false ?", [ELEMENTS]),
    "fem-mean": ("Kernels/Elements/ElementBatches.cxx", "constexpr double largestOfPoints = 4.0;",
                 "constexpr double largestOfPoints = 400.0;", [BEAMS]),
    "fem-transposed": ("Kernels/LinearSolvers/BlockMatrix.cxx", "isRising ? block : ~block", "block", [ELEMENTS]),
    "fem-steps": ("Kernels/FiniteElements/EquilibriumSolver.cxx", "  } while (this->Clamp());\n  return false;",
                  "  } while (false);\n  return false;", [FINITE_ELEMENTS, BEAMS]),
    "fem-sliding": ("Kernels/FiniteElements/TangentSolver.cxx", "  this->Sliding.Constrain(this->Matrix);\n", "",
                    [CONDITIONS]),
    "fem-planes": ("Kernels/Physics/BodyPieces.cxx", "return factors.rank() == 6;",
                   "return factors.rank() >= 5;", [CONDITIONS]),
    "fem-rounded-planes": ("Kernels/Physics/BodyPieces.cxx", "factors.setThreshold(ElasticBody::ParallelSine);",
                           "factors.setThreshold(1e-3 * ElasticBody::ParallelSine);", [CONDITIONS]),
    "fem-levers": ("Kernels/Physics/BodyPieces.cxx", "leastShare * extent);", "1e3 * leastShare * extent);",
                   [CONDITIONS]),
    "fem-free-pieces": ("Kernels/Physics/BodyPieces.cxx", "i < number && !isRigid;", "i < number && false;",
                        [FINITE_ELEMENTS]),
    "fem-dents": ("Kernels/FiniteElements/EquilibriumSolver.cxx",
                  "if (after.IsConverged && other.Potential < state.Potential)", "if (false)", [FINITE_ELEMENTS]),
    "rounding-of-bone": ("Kernels/FiniteElements/EquilibriumSolver.cxx",
                         "      report.IsConverged = this->IsWithinRounding(problem, state, wanted);\n", "",
                         [FINITE_ELEMENTS]),
    "elements-after-stall": ("Filters/Physics/FiniteElementSimulation.cxx",
                             "const std::vector<glm::dvec3> displacements = this->Model.GetStart();",
                             "const std::vector<glm::dvec3> displacements = this->Model.GetDisplacements();",
                             ["Cxx.TestElasticDeformation"]),
    "cut-at-rest": ("Filters/vtkElasticDeformation.cxx", "session.Cut(read, isToReset);", "session.Cut(read, false);",
                    ["Cxx.TestElasticCuts"]),
    "fem-weight": ("Kernels/FiniteElements/EquilibriumProblem.cxx",
                   "volume += shares[point][i] * volumes[t][point];", "volume += 0.1 * volumes[t][point];", [BEAMS]),
    "fem-middle": ("Kernels/Physics/MidSideNodes.cxx", "if (isNew && isTaken[static_cast<std::size_t>(node)])",
                   "if (false)", [("TestMidSideNodes", "*")]),
    "fem-curved": ("Kernels/Physics/ElasticBody.cxx", "constexpr double leastPart = 1e-3;",
                   "constexpr double leastPart = -1e3;", [("TestMidSideNodes", "*")]),
    "fem-colors": ("Kernels/Elements/ElementBatches.cxx",
                   "forNodes([&](std::uint64_t& mask) { mask |= std::uint64_t(1) << color; });", "",
                   [("TestFiniteElements", "*Threads")]),
    "fem-fused": ("Kernels/Common/Lanes.h", '__attribute__((target("avx2")))',
                  '__attribute__((target("avx2,fma"), optimize("fp-contract=fast")))', [("TestElementLanes", "*")]),
    "springs-near": ("Kernels/MassSpring/MassSpringForces.cl",
                     "Dot(displacement, Plus(Plus(rest, rest), displacement)) / (length + restLength)",
                     "length - restLength", [SPRINGS, SPRINGS_AT_REST]),
    "springs-volume": ("Kernels/MassSpring/MassSpringForces.cl",
                       "copysign(materials[2 * packet + 1] * (1.0f / 6.0f), restDeterminant)",
                       "materials[2 * packet + 1] * (1.0f / 6.0f)", [SPRINGS, SPRINGS_AT_REST]),
    "springs-restored": ("Kernels/MassSpring/MassSpringModel.cxx", "impl.State->Restore();", "", [SPRINGS]),
    "springs-limit": ("Kernels/MassSpring/MassSpringNetwork.cxx", "fastest = std::max(fastest, 24.0",
                      "fastest = std::max(0.0, 24.0", [SPRINGS]),
    "springs-corner": ("Kernels/MassSpring/MassSpringNetwork.cxx", "i == corner || j == corner ?",
                       "glm::distance(corners[i], corners[j]) < 1.2 * from ?", [SPRINGS]),
    "springs-flat": ("Kernels/MassSpring/MassSpringResults.cxx", "hasStress = !IsFlat(results.Determinant);",
                     "hasStress = true;", [SPRINGS_AT_REST]),
    "springs-given-up": ("Kernels/MassSpring/MassSpringModel.cxx",
                         "  abortCheck.Check();\n  auto network",
                         "  abortCheck.Check();\n  this->Forget();\n  auto network", [ABORTS]),
    "box-overshoot": ("Kernels/Cutting/DeformedMeshPositions.cxx", "(most * (1.0 + rounding) + rounding)", "(rounding)",
                      [DEFORMED_CUTTING]),
    "box-changes": ("Kernels/Cutting/DeformedFieldPositions.cxx", " - first - 1, 0)", " - first, 0)",
                    [DEFORMED_CUTTING]),
    # The VTK classes.
    "extent-snap": ("Kernels/World/OutputExtent.cxx", "std::round(index * 256.0) / 256.0", "index",
                    ["Cxx.TestDeformGeometry", "Cxx.TestDeformKeptBounds"]),
    "image-direction": ("Kernels/World/ImageGeometry.cxx", "glm::transpose(glm::make_mat3(rows))",
                        "glm::make_mat3(rows)", ["Cxx.TestDeformGeometry"]),
    "image-spacing": ("Kernels/World/ImageGeometry.cxx", "inverse[column] /= this->Spacing",
                      "inverse[column] /= this->Spacing[column]", ["Cxx.TestDeformGeometry", "Cxx.TestDeformGrids"]),
    "world-step": ("Kernels/World/VectorField.cxx", "taken = this->TakeVoxels(volume.PointExtent);", "",
                   ["Cxx.TestCInterface"]),
    "world-map": ("Kernels/World/WorldMesh.cxx", "this->DisplacementsAreOld || toOutput != this->ToOutput",
                  "this->DisplacementsAreOld", ["Cxx.TestCInterface"]),
    "world-revision": ("Kernels/World/VectorField.cxx", "isSame && revision == this->Revision", "isSame",
                       ["Cxx.TestCChainMail"]),
    "world-scan": ("Kernels/World/VectorField.cxx", "changes = this->OnDevice->GetChanges(this->ScannedRevision);",
                   "changes = PointRanges();", ["Cxx.TestCChainMail"]),
    "float-levels": ("Kernels/FiniteElements/TangentSolver.cxx", "MostIterationsWithFloats = 300;",
                     "MostIterationsWithFloats = 1000000;", [FINITE_ELEMENTS, BEAMS]),
    "rounding-of-forces": ("Kernels/FiniteElements/EquilibriumSolver.cxx", "return rounding * this->LeastModulus",
                           "return 1e7 * rounding * this->LeastModulus", [BEAMS]),
    "no-rounding": ("Kernels/FiniteElements/EquilibriumSolver.cxx", "(this->MeanEdge + farthest)",
                    "this->MeanEdge * (farthest < 0.0)", [FINITE_ELEMENTS]),
    "line-of-nodes": ("Kernels/Physics/BodyPieces.cxx",
                      "ElasticBody::ParallelSine * glm::length(offset) * glm::length(along)",
                      "ElasticBody::ParallelSine * glm::dot(along, along)", [("TestElementConditions", "*")]),
    "cut-forces": ("Filters/Physics/ElasticSession.cxx", "forces[node] /= shares[roots[node]];",
                   "forces[node] /= std::min(1, shares[roots[node]]);", ["Cxx.TestElasticCuts"]),
    "jacobian-across": ("Kernels/StaticMapping/VoxelJacobians.cxx", "return glm::any(crosses) ?",
                        "return glm::all(crosses) ?", ["Cxx.TestExtraArrays"]),
    "late-log": ("Filters/vtkArrayChanges.cxx",
                 "array->Modified(); // values may have been written since the array was read", "",
                 ["Cxx.TestArrayChanges"]),
    "open-polyhedron": ("Kernels/Cells/PolyhedronSplit.cxx", "constexpr double rounding = 1e-9;",
                        "constexpr double rounding = 1e9;", ["Cxx.TestHigherOrderCells"]),
    "repeated-nodes": ("Kernels/Cells/CellReader.cxx", "face.erase(std::unique(face.begin(), face.end()), face.end());",
                       "", ["Cxx.TestHigherOrderCells"]),
    "order-on-faces": ("Kernels/Cells/CellParts.cxx", "  OrientFaces(part.Faces);\n", "", ["Cxx.TestDeformCells"]),
    "flat-triangles": ("Kernels/Cutting/Sheet.cxx", "sorted[0] == sorted[1] || sorted[1] == sorted[2] || !known.insert(sorted).second",
                       "known.count(sorted) > 0", ["Cxx.TestSmoothCut"]),
    "kept-without-voxels": ("Kernels/World/MappingCache.cxx", "volume.Outside.FadeDistance > 0.0 &&", "",
                            ["Cxx.TestDeformKeep"]),
    "world-cut": ("Kernels/World/WorldEdits.cxx", "this->BaseCutIsOld = true;", "", ["Cxx.TestCEdits"]),
    "world-boundary": ("Kernels/World/WorldEdits.cxx", "this->BaseDistancesAreOld = true;", "", ["Cxx.TestCEdits"]),
    "world-small": ("Kernels/World/WorldBoxes.cxx", "    if (!IsSmall(box, volume))", "    if (true)",
                    ["Cxx.TestDeformMisuse"]),
    "cut-pair": ("Filters/Arrays/MaskArray.cxx", "(crossed != nullptr) != (cut.Distances.Values != nullptr)", "false",
                 ["Cxx.TestDeformMasks", "Cxx.TestSmoothCut"]),
    "material-range": ("Kernels/SamplingMesh/VoxelMaterials.h", "number < range.Maximum", "number <= range.Maximum",
                       ["Cxx.TestMaterialFromVolume", "Cxx.TestChainMailDeformation"]),
    "material-number": ("Kernels/SamplingMesh/VoxelMaterials.h", "static_cast<T>(static_cast<int>(value)) == value", "true",
                        ["Cxx.TestMaterialFromVolume", "Cxx.TestChainMailMisuse"]),
    "material-preset": ("Filters/vtkMaterialFromVolume.cxx", "table.Exists[i] = true;", "",
                        ["Cxx.TestMaterialFromVolume"]),
    "categories": ("Filters/Arrays/VolumeArrays.cxx", "isId || (array->GetName()", "(array->GetName()",
                   ["Cxx.TestDeformArrays"]),
    "cell-diagonal": ("Kernels/Cells/CellSplit.cxx", "lowest = node(face, i) < node(face, lowest) ? i : lowest;", "",
                      ["Cxx.TestDeformCells", "Cxx.TestHigherOrderCells"]),
    "cell-order": ("Kernels/Cells/CellReader.cxx", "overlap += std::min(ofOneSign, ofOtherSign);",
                   "overlap += 0.0 * std::min(ofOneSign, ofOtherSign);", ["Cxx.TestDeformCells"]),
    "cell-places": ("Kernels/Cells/CellSplit.h",
                    "return this->Place != other.Place ? this->Place < other.Place : this->Number < other.Number;",
                    "return this->Number < other.Number;",
                    ["Cxx.TestDeformMeshes", "Cxx.TestHigherOrderCells"]),
    "rest-failed": ("Filters/DeformationMesh/RestMesh.cxx", "hasFailed = this->ShapeIsOld;", "hasFailed = false;",
                    ["Cxx.TestDeformShortArrays"]),
    "cell-points": ("Filters/DeformationMesh/RestMesh.cxx",
                    "(!this->CellsDependOnPoints || !this->HavePointsChanged(rest, source));", "true;",
                    ["Cxx.TestDeformMeshes", "Cxx.TestHigherOrderCells"]),
    "rest-derived": ("Filters/DeformationMesh/RestMesh.cxx", "(this->Derived.GetCount() == 0 || nodes == nodesBefore)",
                     "true", ["Cxx.TestDeformMeshes"]),
    "body-flat": ("Filters/Meshing/ClosedSurface.cxx", "decimation->AttributeErrorMetricOn();", "",
                  ["Cxx.TestTetGenMesher"]),
    "isovalue-metal": ("Filters/Meshing/BodyIsovalue.cxx", "whole->Share < largestMetal &&", "false &&",
                       ["Cxx.TestTetGenMesher"]),
    "isovalue-padding": ("Filters/Meshing/BodyIsovalue.cxx", "if (limits[0] < LeastTissueInCT)", "if (false)",
                         ["Cxx.TestTetGenMesher"]),
    "time-of-parts": ("Filters/Pipeline/InputUpdate.cxx", "time = std::max(time, array ? array->GetMTime() : 0);",
                      "static_cast<void>(array);", ["Cxx.TestDeformMeshes"]),
    "mask-valid": ("Filters/Arrays/MaskArray.cxx", "isValid == 0 ? vtkDataSetAttributes::HIDDENPOINT : 0", "0",
                   ["Cxx.TestDeformMasks"]),
    "elastic-cells": ("Filters/Physics/BodyReading.cxx",
                      "Stamp stamp = GetCellArraysStamp({ grid });", "Stamp stamp;",
                      ["Cxx.TestElasticDeformation"]),
    "editor-held": ("Filters/Cutting/VolumeEditor.cxx", "!array || array->GetReferenceCount() > 1", "!array",
                    ["Cxx.TestCutVolume", "Cxx.TestCarveVolume"]),
    "sheet-smooth": ("Filters/vtkCutVolume.cxx", "(this->SmoothCut != last.IsSmooth && !sheet.IsEmpty())", "false",
                     ["Cxx.TestSmoothCut"]),
    "sheet-accumulate": ("Filters/vtkCutVolume.cxx", "else if (isNew && !this->Accumulate)", "else if (false)",
                         ["Cxx.TestCutVolume"]),
    "changes-before": ("Filters/vtkArrayChanges.cxx", "time < this->Begin ||", "", ["Cxx.TestArrayChanges"]),
    "changes-copies": ("Filters/vtkArrayChanges.cxx", "log && log->Array == array ? log", "log ? log",
                       ["Cxx.TestArrayChanges"]),
    "mesh-hidden": ("Filters/DeformationMesh/MeshCells.cxx", "if (skipped.ContainPointOf(points, count) || ", "if (",
                    ["Cxx.TestDeformMeshes"]),
    "body-hidden": ("Filters/Physics/BodyReading.cxx", "if (skipped.ContainPointOf(points, size))", "if (false)",
                    ["Cxx.TestElasticDeformation"]),
    "session-border": ("Interaction/SessionPipeline.cxx", "if (inside != index)", "if (false)",
                       ["Cxx.TestDeformVolumeSession"]),
    "points-far": ("Kernels/PointMaps/FieldPointMap.cxx", ", Origin(field.IndexToWorld[3])", ", Origin(0.0)",
                   ["Cxx.TestDeformGeometryFilter"]),
    "edits-part": ("Filters/Pipeline/InputUpdate.cxx", "if (vtkVolumeEditAlgorithm::SafeDownCast(producer))", "if (false)",
                   ["Python.TestInputChanges"]),
    "handle-cell": ("Filters/Physics/BodyReading.cxx", "if (Contains(body, t, position))", "if (false)",
                    ["Cxx.TestElasticDeformation"]),
    "equilibrium-stalled": ("Kernels/FiniteElements/EquilibriumSolver.cxx", "constexpr int tooMany = 15;",
                            "constexpr int tooMany = 150;", ["Kernels.TestFiniteElements"]),
    "jacobian-beside": ("Kernels/StaticMapping/VoxelJacobians.cxx",
                        "alongField[axis] = this->GetSlopeBeside(middle, axis, halfStep);",
                        "alongField[axis] = glm::dvec3(0.0);", ["Cxx.TestExtraArrays"]),
    "voxel-rounding": ("Kernels/ChainMail/ChainMailHandles.cxx", "constexpr double rounding = 1e-6;",
                       "constexpr double rounding = 0.0;", [RELAXATION]),
    "handle-rounding": ("Filters/Physics/BodyReading.cxx", "constexpr double rounding = 1e-6;",
                        "constexpr double rounding = 0.0;", ["Cxx.TestElasticDeformation"]),
    "face-forces": ("Kernels/Physics/MidSideNodes.cxx", "] += face.Area;", "] += 1.0;",
                    [("TestMidSideNodes", "*")]),
    "reactions": ("Kernels/FiniteElements/EquilibriumProblem.cxx", "? left - sliding.Project(node, left)",
                  "? sliding.Project(node, left)", ["Cxx.TestTenNodeElements"]),
    "springs-last-frame": ("Filters/Physics/MassSpringSimulation.cxx", "if (!frame.IsLast)", "if (false)",
                           ["Cxx.TestElasticDeformation"]),
    "body-unit": ("Filters/Physics/BodyReading.cxx", "radius * settings.UnitLength", "radius",
                  ["Cxx.TestElasticDeformation"]),
    "body-taken": ("Filters/Physics/BodyReading.cxx", "isTaken[node] == 0 && ", "", ["Cxx.TestElasticDeformation"]),
    "body-fixed": ("Filters/Physics/BodyReading.cxx", "value != 0.0 ? 1 : 0", "value > 0.0 ? 0 : 1",
                   ["Cxx.TestElasticDeformation"]),
    "body-freed": ("Filters/Physics/MassSpringSimulation.cxx", "std::fill_n(&velocities[3 * node], 3, 0.0F);", "",
                   ["Cxx.TestElasticDeformation"]),
    "body-arrays": ("Filters/Physics/ElasticSession.cxx", "data.push_back(this->BodyStamp.back());", "",
                    ["Cxx.TestTenNodeElements"]),
    "tool-lift": ("Filters/Cutting/ToolPath.h", "this->Positions.clear();\n    this->Done.clear();",
                  "this->Positions.clear();", ["Cxx.TestCutVolume"]),
    "sheet-hidden": ("Filters/Cutting/SheetReading.cxx", "!skipped.Contain(first++) && ", "first++ >= 0 && ",
                     ["Cxx.TestCutVolume"]),
    "source-times": ("Filters/Pipeline/InputUpdate.cxx", "info->Get(Pipeline::UPDATE_TIME_STEP()) != time)", "false)",
                     ["Cxx.TestDeformTime"]),
    "rank-grids": ("Filters/Pipeline/InputGeometry.cxx", "!ranks.AreEqual(hash)", "!ranks.AreEqual(hash) && false",
                   ["Parallel.TestDeformRanks.3"]),
    "mapping-parts": ("Kernels/World/MappingCache.cxx", "(!volume.IsWhole() && (builder.HoldsVoxels()",
                      "(false && (builder.HoldsVoxels()", ["Cxx.TestDeformStreaming"]),
    "keep-fade": ("Kernels/DeformationMesh/OutsideVoxels.h", "(3.0 - 2.0 * distance)", "(3.0 - 1.9 * distance)", ["Kernels.TestFadedLinks"]),
    "keep-field": ("Kernels/Displacements/FieldFading.cl", "(3.0f - 2.0f *", "(3.0f - 1.9f *", ["Cxx.TestDeformKeepField"]),
    "keep-field-parts": ("Kernels/DeformationMesh/RestRegions.cxx", "displacement.Add(glm::dvec3(0.0));", "",
                         ["Cxx.TestDeformKeepField"]),
    "keep-far": ("Kernels/StaticMapping/FadedLinks.cxx", "farUntil = x +", "farUntil = x + 2 +", ["Kernels.TestFadedLinks"]),
    "keep-closest": ("Kernels/Common/BoxTree.h", "if (!isTooFar(far.Distance))", "if (false)",
                     ["Kernels.TestFadedLinks"]),
    "keep-jump": ("Kernels/StaticMapping/StretchedTetrahedra.cxx", "const bool isJump = ", "const bool isJump = false && ",
                  ["Kernels.TestFadedLinks"]),
    "keep-bounds": ("Kernels/StaticMapping/FadedLinks.cxx", "bounds.Add(move(block.Voxels, block.GreatestWeight, displacement));",
                    "bounds.Add(move(block.Voxels, 0.0, displacement));", ["Kernels.TestFadedLinks"]),
    "keep-split": ("Kernels/StaticMapping/FadedMesh.cxx", "std::copy(nodes.begin(), nodes.end(), faded.After.begin());",
                   "std::copy(nodes.begin(), nodes.begin(), faded.After.begin());",
                   ["Kernels.TestFadedLinks", "Cxx.TestDeformKeep"]),
    "keep-edge": ("Kernels/StaticMapping/FadedLinks.cxx", "*link = MakeLink(still, glm::dvec3(0.0));", "",
                  ["Cxx.TestDeformKeep"]),
    "bounds-grown": ("Filters/DeformVolume/vtkDeformVolumeFilterBounds.cxx", "    this->BoundsHaveGrown = true;\n", "",
                     ["Cxx.TestDeformContinuousTime", "Cxx.TestDeformTime"]),
    "bounds-held": ("Filters/DeformVolume/vtkDeformVolumeFilterBounds.cxx", "\n  this->BoundsHaveGrown = true;\n", "\n",
                    ["Cxx.TestDeformTime"]),
    "body-growth": ("Filters/Meshing/vtkTetGenMesherVolume.cxx", "outside.empty()", "true", ["Cxx.TestTetGenMesherBodies"]),
    "chainmail-cut": ("Filters/Engine/ChainMailSession.cxx",
                      "SwitchOffCut(masks, static_cast<std::size_t>(volume->GetNumberOfCells()));", "",
                      ["Cxx.TestSmoothCut", "Cxx.TestDeformVolumeSession"]),
    "session-visible": ("Interaction/SessionPipeline.cxx", "? found : shown;", "? found : found;",
                        ["Cxx.TestDeformVolumeSession"]),
    "session-range": ("Interaction/SessionPipelineModel.cxx", "    this->CheckDisplacements();\n", "",
                      ["Cxx.TestDeformVolumeSession"]),
    "session-carvings": ("Interaction/SessionPipelineHistory.cxx",
                         "edit < action.NumberOfEdits; ++edit)\n      {\n        this->CarveFilter->Undo();",
                         "edit < 1; ++edit)\n      {\n        this->CarveFilter->Undo();",
                         ["Cxx.TestDeformVolumeSession"]),
    "session-model": ("Interaction/SessionPipelineHistory.cxx", "this->Model = action.FormerModel;", "",
                      ["Cxx.TestDeformVolumeSession"]),
    "session-hash": ("Interaction/SessionFiles.cxx", "hash.Add(volume->GetSpacing(), 3 * sizeof(double));", "",
                     ["Cxx.TestDeformVolumeSession"]),
    "session-fixed": ("Interaction/SessionFiles.cxx", "    arrays.AddByName(mesh->GetPointData());\n", "",
                      ["Cxx.TestDeformVolumeSession"]),
    "session-field": ("Interaction/SessionPositions.cxx", "step == 1 ? part[axis] : 1.0 - part[axis]",
                      "step == 0 ? part[axis] : 1.0 - part[axis]", ["Cxx.TestDeformVolumeSession"]),
    "pick-covered": ("Interaction/VisiblePositions.cxx", "this->Covered->GetComponent(voxel, 0) == 0.0 ? -1 : voxel",
                     "false ? -1 : voxel", ["Cxx.TestDeformVolumeInteractorStyle"]),
    # Updates of an edited pipeline.
    "moved-blocks": ("Kernels/World/IndexDeformation.cxx", "if (this->BlockVersions[block] <= version)",
                     "if (this->BlockVersions[block] <= version + 1)", [PIPELINES]),
    "moved-scale": ("Filters/Displacements/Deformation.cxx", "source.DisplacementScale == last.DisplacementScale && ", "",
                    [PIPELINES]),
    "moved-rest": ("Filters/Displacements/Deformation.cxx", " || (ofPoints && !this->Mesh.HasKeptPoints())", "",
                   ["Cxx.TestDeformGrids"]),
    "moved-errors": ("Kernels/World/IndexDeformation.cxx", "  this->VectorsAreWhole = false;\n", "", [PIPELINES]),
    "field-undefined": ("Filters/Displacements/DeformationField.cxx", "if (undefined != this->UndefinedPoints ||",
                        "if (undefined.size() != this->UndefinedPoints.size() ||",
                        ["Cxx.TestUndefinedVectors"]),
    "field-spacing": ("Filters/Displacements/DeformationField.cxx", "lastSpacing != this->FieldSpacing || ",
                      "lastSpacing != lastSpacing || ", ["Cxx.TestUndefinedVectors"]),
    "rest-points-kept": ("Filters/DeformationMesh/RestMesh.cxx", "this->KeptPoints && !hasFailed", "this->KeptPoints",
                         ["Cxx.TestArrayChanges"]),
    "resampler-error": ("Kernels/World/ResamplerChoice.cxx", "catch (const MemoryError&)", "catch (const Error&)",
                        ["Cxx.TestDeformRasterization"]),
    "cache-lock": ("Kernels/Drivers/KernelCache.cxx", "flock(Lock, LOCK_EX | LOCK_NB) != 0", "false",
                   [("TestCompilation", "*WaitsForOtherProcesses")]),
    "image-object": ("Filters/DeformVolume/vtkDeformVolumeFilterVolume.cxx",
                     "now.second > this->ImageRead.GetMTime()", "false", ["Cxx.TestDeformCaching"]),
    "mesh-object": ("Filters/DeformationMesh/MeshStamp.cxx", "this->Times == last.Times && ", "",
                    ["Cxx.TestDeformCaching"]),
    "points-undefined": ("Kernels/PointMaps/FieldPointMap.h", "this->Undefined && this->Undefined[point]", "false",
                         ["Cxx.TestDeformGeometryFilter"]),
    "field-log": ("Filters/Displacements/DeformationField.cxx", "written ? this->VectorsVersion : NoVersion;",
                  "this->VectorsVersion;", [PIPELINES]),
    "points-upright": ("Kernels/PointMaps/MeshPointMap.cxx", "found.IsInverted = !isAtRest &&",
        "found.IsInverted = false &&", ["Cxx.TestDeformGeometryFilter"]),
    "points-first": ("Kernels/PointMaps/MeshPointMap.cxx", "this->Order.ComesBefore(number, best.Number)",
        "this->Order.ComesBefore(best.Number, number)", ["Cxx.TestDeformGeometryFilter"]),
    "points-boundary": ("Kernels/PointMaps/MeshPointMap.cxx", "constexpr double MeshBoundaryTolerance = 1e-6;",
        "constexpr double MeshBoundaryTolerance = 1e-9;", ["Cxx.TestDeformGeometryFilter"]),
    "points-slope": ("Kernels/DeformationMesh/OutsideVoxels.h", "return 6.0 * distance", "return 3.0 * distance",
        ["Cxx.TestDeformGeometryFilter"]),
    "points-projection": ("Kernels/PointMaps/MeshPointMap.cxx", "weight * displacement.Gradient * projection",
        "weight * displacement.Gradient", ["Cxx.TestDeformGeometryFilter"]),
    "points-cells": ("Kernels/PointMaps/FieldPointMap.cxx", "std::make_tuple(this->IsBeside, this->IsInverted, this->Number) <",
        "std::make_tuple(this->IsBeside, false, this->Number) <", ["Cxx.TestDeformGeometryFilter"]),
    "points-clamped": ("Kernels/PointMaps/FieldPointMap.cxx", "weight * gradient * reported *",
        "weight * gradient *", ["Cxx.TestDeformGeometryFilter"]),
    "points-newton": ("Kernels/PointMaps/FieldPointMap.cxx", "  if (isBeside)\n", "  if (false)\n",
        ["Cxx.TestDeformGeometryFilter"]),
    "points-reported": ("Kernels/PointMaps/FieldPointMap.cxx",
        "reported[axis][axis] = beyond > inside.Field.Tolerance", "reported[axis][axis] = beyond > 0.0",
        ["Cxx.TestDeformGeometryFilter"]),
    "points-hidden": ("Kernels/PointMaps/FieldPointMap.cxx", "if (!inside.IsDefined(cell, position))",
        "if (false)", ["Cxx.TestDeformGeometryFilter"]),
    "points-beside": ("Kernels/PointMaps/FieldPointMap.cxx", "if (found.IsBeside)\n",
        "if (false)\n", ["Cxx.TestDeformGeometryFilter"]),
    "points-normals": ("Filters/Output/TransformedArrays.cxx", "return length > 0.0 ? sign / length * turned : turned;",
        "return length > 0.0 ? sign / length * (gradient * normal) : turned;", ["Cxx.TestDeformGeometryFilter"]),
    "points-current": ("Filters/Displacements/WorldDeformation.cxx", "source.DisplacementScale == this->LastScale",
        "true", ["Cxx.TestDeformGeometryFilter"]),
    "points-direction": ("Filters/vtkDeformGeometryFilter.cxx", "this->IsInverted = this->Self->Inverse != (isField",
        "this->IsInverted = this->Self->Inverse || (isField", ["Cxx.TestDeformGeometryFilter"]),
    "keep-dropped": ("Kernels/World/DeviceSession.cxx", "        this->HasFadedMesh = false;\n", "",
                     ["Cxx.TestDeformKeep"]),
    "split-places": ("Kernels/World/DeviceSession.cxx", "|| (openSplits && hasSplit)", "", [PIPELINES]),
    "split-shape": ("Filters/DeformationMesh/RestMesh.cxx",
                    "inPlace &= this->Points[change.Before[k]] == this->Points[change.After[k]];",
                    "inPlace &= change.Before[k] >= 0;", [PIPELINES]),
    "split-bounds": ("Filters/DeformVolume/vtkDeformVolumeFilterBounds.cxx",
                     "this->State->BoundsOfMesh.ChangeConnectivity(mesh.GetPoints(), *changes);",
                     "static_cast<void>(changes);", [PIPELINES]),
    "mask-by-edit": ("Filters/Arrays/VolumeArrays.cxx", "(value & (Hidden | HiddenByEdit)) == Hidden", "(value & Hidden) != 0",
                     ["Cxx.TestCarveVolume"]),
    "mask-hidden": ("Filters/Arrays/VolumeArrays.cxx",
                    "masks.Joined.empty() && !arrays[HiddenCells] && HasSameMask(arrays, HiddenCells, last)",
                    "masks.Joined.empty()", ["Cxx.TestArrayChanges"]),
    "long-axis": ("Kernels/Output/OutputSlab.cxx", "if (GetSize(this->WholeExtent, axis)", "if (GetSize(this->GetExtent(), axis)",
                  ["Cxx.TestDeformStreaming"]),
    "background-of-nan": ("Kernels/DeviceVolume/DeviceArrays.cxx",
                          "const bool areNaN = ", "const bool areNaN = false && ", ["Cxx.TestDeformCaching"]),
    "removed-cache": ("Kernels/Drivers/KernelCache.cxx", "errno == ENOENT", "errno == EXDEV",
                      ["Cxx.TestEnvironment.RemovedCache"]),
    "fork": ("Kernels/OpenCL/OpenCLContext.cxx", "process != getpid()", "process == 1", ["Cxx.TestEnvironment.Fork"]),
    "outputs-held": ("Filters/Output/OutputArrays.cxx", "this->Array->GetReferenceCount() > 1",
                     "this->Array->GetReferenceCount() > 2", [PIPELINES]),
    "outputs-written": ("Filters/Output/OutputArrays.cxx", "this->Array->GetMTime() == this->Modified &&", "",
                        [PIPELINES]),
    "changed-factor": ("Filters/DeformVolume/vtkDeformVolumeFilterExecution.cxx", "if (!hasComparableOutput)",
                       "if (!hasComparableOutput && false)", ["Cxx.TestDeformSamplingFactor"]),
    "ignored-on-rank": ("Filters/DeformationMesh/MeshGathering.cxx", "GetFirstText(ranks, piece.IgnoredCells)",
                        "piece.IgnoredCells", ["Parallel.TestDeformRanks.3"]),
    "piece-errors": ("Filters/Pipeline/PieceRequest.h", "info->Get(key) > 1 ? 1 : 0", "info->Get(key) > 9 ? 1 : 0",
                     ["Parallel.TestPhysicsRanks.3"]),
    "carve-label-part": ("Filters/Cutting/vtkCarveVolumeExecution.cxx", "labels && isWhole &&",
                         "labels && (isWhole || true) &&", ["Parallel.TestEditRanks.3"]),
    # The plugin.
    "plugin-padding": ("Plugin/CutVolume.xml", 'mode="approximate_cell_length"',
                       'mode="normal"', ["ParaView.TestEdits"]),
    "plugin-command": ("Plugin/CarveVolume.xml", 'command="SetSmoothBoundary"', 'command="SetAccumulate"', [PROPERTIES]),
    "plugin-port": ("Plugin/CutVolume.xml", 'command="SetSheetConnection">', 'command="SetRestConnection">', [PROPERTIES]),
    "plugin-background": ("Plugin/BackgroundDomain.cxx", "range[0] <= range[1] ? range[0] : 0.0", "0.0", [PROPERTIES]),
    "plugin-unsigned": ("Plugin/BackgroundDomain.cxx", "GetDataTypeMin(array->GetDataType()) >= 0.0", "GetDataTypeMin(array->GetDataType()) > 0.0",
                        [PROPERTIES]),
    "plugin-widgets": ("Plugin/DeformVolumeMethod.xml", 'animateable="0"\n                            panel_visibility="advanced"',
                       'animateable="0"', ["ParaView.TestProxies"]),
    "plugin-default": ("Plugin/ElasticDeformation.xml", 'default_values="0.3"', 'default_values="0.35"', [PROPERTIES]),
    "plugin-materials": ("Plugin/ChainMailDeformation.xml", "3 0.95 1.05 0.05", "3 0.95 1.05 0.5", [PROPERTIES]),
    "plugin-array": ("Plugin/VolumeEdit.xml", '";2;0;0;"', '";1;0;0;"', [PROPERTIES]),
    "plugin-limit": ("Plugin/ElasticDeformation.xml", 'max="0.494"', 'max="0.5"', [PROPERTIES]),
    "plugin-list": ("Plugin/TetGenMesher.xml", 'clean_command="ClearLabels"', 'clean_command="ClearRefinementSpheres"',
                    [PROPERTIES]),
    "plugin-step": ("Plugin/MassSpringDeformation.xml", 'command="SetTimeStep"', 'command="SetDamping"', [PROPERTIES]),
    "plugin-button": ("Plugin/VolumeEdit.xml", 'command="Redo"', 'command="Undo"', ["ParaView.TestProxies"]),
    "plugin-fetch": ("Plugin/InformationRefresh.cxx", "proxy->UpdatePropertyInformation();", "", [PROPERTIES]),
    "plugin-classes": ("Plugin/InformationRefresh.cxx", 'className == "vtkCutVolume" ||', "", [PROPERTIES]),
    "plugin-servers": ("Plugin/InformationRefresh.cxx",
                       "module->AddObserver(vtkCommand::ConnectionCreatedEvent, connected);", "",
                       ["ParaView.TestClientServer"]),
    "plugin-major": ("Plugin/VersionCheck.cxx", "built[0] != running[0]", "false", ["ParaView.TestVersions"]),
    "plugin-minor": ("Plugin/VersionCheck.cxx", "built[1] != running[1]", "false", ["ParaView.TestVersions"]),
    "state-removed": ("Filters/vtkDeformVolumeFilter.cxx", "else if (value != found->Default)", "else if (false)",
                      ["ParaView.TestOldFiles"]),
    "state-forgets": ("Plugin/InformationRefresh.cxx", "property->ResetToXMLDefaults();", ";",
                      ["ParaView.TestOldFiles"]),
}


def copy_sources():
    """Copies the files of the working tree that git does not ignore. Files that have not changed keep their time."""
    names = subprocess.run(
        ["git", "ls-files", "--cached", "--others", "--exclude-standard"], cwd=SOURCE, check=True,
        capture_output=True, text=True).stdout.splitlines()
    for name in names:
        if (SOURCE / name).is_file():
            write(COPY / name, (SOURCE / name).read_bytes())
    # Remove files that no longer exist in the working tree. Otherwise the compiler would find headers at former paths.
    for path in COPY.rglob("*"):
        if path.is_file() and not (SOURCE / path.relative_to(COPY)).is_file():
            path.unlink()


def write(path, content):
    if path.is_file() and path.read_bytes() == content:
        return
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(content)


def is_of_plugin(test):
    return isinstance(test, str) and test.startswith("ParaView.")


def get_program(test):
    if not isinstance(test, str) or test.startswith("Kernels."):
        return "DeformVolumeEngineTests"
    if test.startswith("C."):
        return test.partition(".")[2] + "C"
    return "DeformVolumeFuzz" if test == PIPELINES else "DeformVolumeCxxTests"


def configure(folder, *options):
    if not (folder / "build.ninja").is_file():
        subprocess.run(
            ["cmake", "-S", COPY, "-B", folder, "-G", "Ninja", "-DCMAKE_BUILD_TYPE=Release",
             "-DBUILD_TESTING=ON", "-DDEFORMVOLUME_BUILD_EXAMPLES=OFF", "-DDEFORMVOLUME_BUILD_BENCHMARKS=OFF",
             "-DPython3_EXECUTABLE=/usr/bin/python3", *options],
            check=True, stdout=subprocess.DEVNULL)


def build(tests):
    """Returns whether the build succeeded. If not, prints the output of the compiler."""
    commands = []
    targets = {get_program(test) for test in tests if not is_of_plugin(test)}
    if targets:
        configure(BUILD, "-DDEFORMVOLUME_WRAP_PYTHON=OFF")
        commands.append(["cmake", "--build", BUILD, "--target", *sorted(targets)])
    if any(map(is_of_plugin, tests)):
        # The same options as in the preset paraview.
        configure(PLUGIN_BUILD, "-DDEFORMVOLUME_USE_PARAVIEW=ON", "-DDEFORMVOLUME_TEST_KERNELS=OFF",
                  "-DDEFORMVOLUME_TEST_CLASSES=OFF", f"-DDEFORMVOLUME_TEST_KERNEL_CACHE={WORK / 'plugin-kernels'}",
                  f"-DCMAKE_PREFIX_PATH={SOURCE / 'build' / 'paraview-prefix' / 'usr'}")
        commands.append(["cmake", "--build", PLUGIN_BUILD])
    for command in commands:
        result = subprocess.run(command, capture_output=True, text=True)
        if result.returncode:
            print(result.stdout[-4000:], file=sys.stderr)
            return False
    return True


def get_command(test):
    """Returns the name of the test, and its command."""
    if is_of_plugin(test):
        # CTest sets the environment of the test.
        return test, ["ctest", "--test-dir", PLUGIN_BUILD, "-R", f"^{re.escape(test)}$", "--no-tests=error"]
    program = BUILD / "bin" / get_program(test)
    if test == PIPELINES:
        # The same arguments as in CTest.
        return test, [program, "--seed", "3001", "--count", "160"]
    if isinstance(test, str) and test.startswith("C."):
        return test, [program]
    if isinstance(test, str):
        name = test.partition(".")[2]
        command = [program, f"--files={name}", "-T", WORK, "-D", SOURCE / "Testing" / "Data"]
        window = ["xvfb-run", "-a", "-s", "-noreset -screen 0 1280x1024x24"] if name in WITH_WINDOW else []
        return test, [*window, *command]
    files, pattern = test
    names, _, device = files.partition("@")
    return names, [program, f"--files={names}",
                   *([f"--device={device}"] if device else []), f"--gtest_filter={pattern}", "--gtest_fail_fast"]


def find_failure(tests):
    """Returns the name of the first test that fails, or None."""
    environment = dict(os.environ, POCL_CACHE_DIR=str(WORK / "kernel-cache"))
    pathlib.Path(environment["POCL_CACHE_DIR"]).mkdir(parents=True, exist_ok=True)
    for test in tests:
        name, command = get_command(test)
        try:
            result = subprocess.run(command, capture_output=True, text=True, env=environment, timeout=600)
        except subprocess.TimeoutExpired:
            return f"{name} (does not end)"
        if result.returncode == SKIPPED or (is_of_plugin(test) and "***Skipped" in result.stdout):
            print(f"{name} was skipped", file=sys.stderr)
            continue
        if result.returncode < 0:
            return f"{name} (signal {-result.returncode})"
        if isinstance(test, str) and not is_of_plugin(test) and ERROR.search(result.stdout + result.stderr):
            return name
        if result.returncode:
            failed = [line for line in result.stdout.splitlines() if line.startswith("[  FAILED  ]")]
            return failed[0].split("]")[1].split(",")[0].split("(")[0].strip() if failed else name
    return None


def find_stale():
    """Returns a message for each mutation whose text does not exist exactly once in its file."""
    counts = {name: (SOURCE / file).read_text().count(old) for name, (file, old, _, _) in MUTATIONS.items()}
    return [f"{name}: the text exists {count} times in {MUTATIONS[name][0]}."
            for name, count in counts.items() if count != 1]


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("names", nargs="*", metavar="NAME")
    parser.add_argument("--list", action="store_true", help="print the names of the mutations")
    parser.add_argument("--check", action="store_true", help="only check that each text exists once")
    arguments = parser.parse_args()
    if arguments.list:
        print("\n".join(MUTATIONS))
        return 0
    stale = find_stale()
    if stale or arguments.check:
        print("\n".join(stale), file=sys.stderr)
        return 1 if stale else 0
    names = arguments.names or list(MUTATIONS)
    unknown = [name for name in names if name not in MUTATIONS]
    if unknown:
        parser.error("there is no mutation " + ", ".join(unknown))
    copy_sources()
    tests = list(dict.fromkeys(test for name in names for test in MUTATIONS[name][3]))
    if not build(tests):
        print("The sources do not build without a change.", file=sys.stderr)
        return 1
    failure = find_failure(tests)
    if failure:
        print(f"{failure} fails without a change.", file=sys.stderr)
        return 1
    print("| Mutation | File | From | To | Caught by |\n|---|---|---|---|---|", flush=True)
    survived = 0
    for name in names:
        file, old, new, its_tests = MUTATIONS[name]
        text = (SOURCE / file).read_text()
        write(COPY / file, text.replace(old, new).encode())
        built = build(its_tests)
        caught = find_failure(its_tests) if built else "the compiler"
        write(COPY / file, text.encode())
        survived += caught is None
        row = [name, file, f"`{old}`", f"`{new}`", caught or "**nothing**"]
        print("| " + " | ".join(row) + " |", flush=True)
    return 1 if survived else 0


if __name__ == "__main__":
    sys.exit(main())
