/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * dv_deformer in C: misuse and error messages, progress and abort, densities, parts of the output.
 * Examples/minimal-c shows the usual calls. Testing/Cxx/C/TestCInterface.cxx compares the results
 * with those of the filter.
 */
#include "Check.h"
#include "Cube.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum
{
  SIZE = 12,
  VOXELS = SIZE * SIZE * SIZE
};

static int16_t Values[VOXELS];
static int16_t Output[VOXELS];
static int8_t Coverage[VOXELS];
static void* Outputs[1];
static double Corners[8][3];
static float Displacements[8][3];
static int64_t Tetrahedra[5][4] = { { 0, 1, 2, 4 }, { 3, 2, 1, 7 }, { 5, 4, 7, 1 }, { 6, 7, 4, 2 },
  { 1, 2, 4, 7 } };

static dv_array MakeArray(void)
{
  dv_array array;
  memset(&array, 0, sizeof(array));
  array.struct_size = sizeof(array);
  array.data = Values;
  array.type = DV_INT16;
  array.components = 1;
  array.background = -5.0;
  return array;
}

static dv_mesh MakeMesh(void)
{
  dv_mesh mesh;
  memset(&mesh, 0, sizeof(mesh));
  mesh.struct_size = sizeof(mesh);
  mesh.number_of_points = 8;
  mesh.points = Corners;
  mesh.point_type = DV_FLOAT64;
  mesh.number_of_cells = 5;
  mesh.connectivity = Tetrahedra[0];
  return mesh;
}

static dv_request MakeRequest(void)
{
  dv_request request;
  memset(&request, 0, sizeof(request));
  request.struct_size = sizeof(request);
  request.number_of_outputs = 1;
  request.outputs = Outputs;
  request.coverage = Coverage;
  return request;
}

/* A dv_deformer with all inputs. The output has the extent of the volume. */
static dv_deformer* MakeDeformer(void)
{
  dv_deformer* deformer = NULL;
  const dv_grid grid = MakeCube(SIZE);
  const dv_array array = MakeArray();
  const dv_mesh mesh = MakeMesh();
  dv_output output;
  memset(&output, 0, sizeof(output));
  output.struct_size = sizeof(output);
  output.bounds_mode = DV_BOUNDS_VOLUME;
  CHECK(dv_create(&deformer) == DV_OK);
  CHECK(dv_set_volume(deformer, &grid) == DV_OK);
  CHECK(dv_set_arrays(deformer, 1, &array) == DV_OK);
  CHECK(dv_set_mesh(deformer, &mesh) == DV_OK);
  CHECK(dv_set_displacements(deformer, DV_FLOAT32, 8, Displacements) == DV_OK);
  CHECK(dv_set_output(deformer, &output) == DV_OK);
  return deformer;
}

static void TestNull(void)
{
  dv_deformer* deformer = NULL;
  dv_grid grid = MakeCube(SIZE);
  const dv_request request = MakeRequest();
  uint64_t bytes = 0;
  REFUSED(dv_create(NULL), "null");
  REFUSED(dv_set_device(NULL, ""), "deformer is null");
  REFUSED(dv_set_memory_limit(NULL, 0), "deformer is null");
  REFUSED(dv_set_volume(NULL, &grid), "deformer is null");
  REFUSED(dv_set_arrays(NULL, 0, NULL), "deformer is null");
  REFUSED(dv_set_blanked(NULL, NULL), "deformer is null");
  REFUSED(dv_set_active_tetrahedra(NULL, NULL), "deformer is null");
  REFUSED(dv_set_boundary_distances(NULL, NULL), "deformer is null");
  REFUSED(dv_set_smooth_cut(NULL, NULL, NULL), "deformer is null");
  REFUSED(dv_set_mesh(NULL, NULL), "deformer is null");
  REFUSED(dv_set_displacements(NULL, DV_FLOAT32, 8, Displacements), "deformer is null");
  REFUSED(dv_set_field(NULL, NULL), "deformer is null");
  REFUSED(dv_set_outside(NULL, DV_OUTSIDE_DISCARD, 0.0), "deformer is null");
  REFUSED(dv_set_reference(NULL, NULL), "deformer is null");
  REFUSED(dv_set_output(NULL, NULL), "deformer is null");
  REFUSED(dv_output_grid(NULL, &grid), "deformer is null");
  REFUSED(dv_deform(NULL, &request, NULL), "deformer is null");
  REFUSED(dv_deform_points(NULL, NULL, NULL), "deformer is null");
  REFUSED(dv_device_memory(NULL, &bytes), "deformer is null");
  REFUSED(dv_release_memory(NULL), "deformer is null");
  dv_destroy(NULL);

  CHECK(dv_create(&deformer) == DV_OK);
  REFUSED(dv_set_volume(deformer, NULL), "the volume is null");
  REFUSED(dv_set_arrays(deformer, 1, NULL), "the array is null");
  REFUSED(dv_set_mesh(deformer, NULL), "the mesh is null");
  REFUSED(dv_set_field(deformer, NULL), "the field is null");
  REFUSED(dv_output_grid(deformer, NULL), "the grid is null");
  REFUSED(dv_deform(deformer, NULL, NULL), "the request is null");
  REFUSED(dv_deform_points(deformer, NULL, NULL), "the request is null");
  REFUSED(dv_device_memory(deformer, NULL), "null");
  REFUSED(dv_set_device(deformer, "no such device"), "no such device");
  dv_destroy(deformer);
}

static void TestMissing(void)
{
  dv_deformer* deformer = NULL;
  dv_grid grid = MakeCube(SIZE);
  const dv_array array = MakeArray();
  const dv_mesh mesh = MakeMesh();
  const dv_request request = MakeRequest();
  CHECK(dv_create(&deformer) == DV_OK);
  REFUSED(dv_set_arrays(deformer, 1, &array), "no volume");
  REFUSED(dv_set_blanked(deformer, (const uint8_t*)Coverage), "no volume");
  REFUSED(dv_output_grid(deformer, &grid), "no volume");
  CHECK(dv_set_volume(deformer, &grid) == DV_OK);
  REFUSED(dv_set_displacements(deformer, DV_FLOAT32, 8, Displacements), "no deformation mesh");
  CHECK(dv_output_grid(deformer, &grid) == DV_OK);
  REFUSED(dv_deform(deformer, &request, NULL), "no arrays");
  CHECK(dv_set_arrays(deformer, 1, &array) == DV_OK);
  CHECK(dv_set_mesh(deformer, &mesh) == DV_OK);
  REFUSED(dv_deform(deformer, &request, NULL), "no displacements");
  dv_destroy(deformer);
}

static void TestWrong(void)
{
  const double infinity = HUGE_VAL;
  dv_deformer* deformer = MakeDeformer();
  dv_grid grid = MakeCube(SIZE);
  dv_array array = MakeArray();
  dv_mesh mesh = MakeMesh();
  dv_request request = MakeRequest();
  dv_report report;
  dv_output output;
  dv_field field;
  void* nothing[1] = { NULL };
  int64_t offsets[6] = { 0, 4, 8, 12, 16, 20 };
  uint8_t types[5] = { 10, 10, 10, 10, 10 };
  int64_t faces[17] = { 4, 3, 3, 2, 1, 3, 3, 2, 7, 3, 3, 1, 7, 3, 2, 1, 7 };
  int i = 0;

  /* Sizes of structures. */
  grid.struct_size = 8;
  REFUSED(dv_set_volume(deformer, &grid), "struct_size of the volume is 8");
  REFUSED(dv_set_reference(deformer, &grid), "struct_size");
  REFUSED(dv_output_grid(deformer, &grid), "struct_size");
  array.struct_size = 0;
  REFUSED(dv_set_arrays(deformer, 1, &array), "struct_size of the array is 0");
  mesh.struct_size = 0;
  REFUSED(dv_set_mesh(deformer, &mesh), "struct_size");
  request.struct_size = 0;
  REFUSED(dv_deform(deformer, &request, NULL), "struct_size of the request");
  request = MakeRequest();
  report.struct_size = 0;
  REFUSED(dv_deform(deformer, &request, &report), "struct_size of the report");

  /* Grids. */
  grid = MakeCube(SIZE);
  grid.extent[3] = -1;
  REFUSED(dv_set_volume(deformer, &grid), "on axis y is 0 to -1");
  grid.extent[3] = 2147483647;
  REFUSED(dv_set_volume(deformer, &grid), "2^29");
  grid = MakeCube(SIZE);
  grid.extent[5] = 0;
  REFUSED(dv_set_volume(deformer, &grid), "one voxel only on axis z");
  grid.extent[1] = grid.extent[3] = grid.extent[5] = 500000000;
  REFUSED(dv_set_volume(deformer, &grid), "2^48");
  grid = MakeCube(SIZE);
  grid.origin[1] = infinity;
  REFUSED(dv_set_volume(deformer, &grid), "origin");
  REFUSED(dv_set_reference(deformer, &grid), "origin of the reference grid");
  grid = MakeCube(SIZE);
  grid.spacing[2] = 0.0;
  REFUSED(dv_set_volume(deformer, &grid), "spacing of the volume on axis z is 0");
  grid.spacing[2] = infinity - infinity;
  REFUSED(dv_set_volume(deformer, &grid), "spacing");
  grid = MakeCube(SIZE);
  grid.direction[4] = 0.0;
  REFUSED(dv_set_volume(deformer, &grid), "no inverse");
  grid.direction[4] = infinity - infinity;
  REFUSED(dv_set_volume(deformer, &grid), "no inverse");

  /* Arrays. */
  array = MakeArray();
  array.data = NULL;
  REFUSED(dv_set_arrays(deformer, 1, &array), "Array 0 has no data");
  array = MakeArray();
  array.type = 10;
  REFUSED(dv_set_arrays(deformer, 1, &array), "type 10");
  array = MakeArray();
  array.components = 0;
  REFUSED(dv_set_arrays(deformer, 1, &array), "0 components");
  REFUSED(dv_set_arrays(deformer, -1, &array), "-1");
  array = MakeArray();
  array.categorical = array.density = 1;
  REFUSED(dv_set_arrays(deformer, 1, &array), "Array 0 is a density and categorical");

  /* Meshes. */
  mesh = MakeMesh();
  mesh.number_of_points = 0;
  REFUSED(dv_set_mesh(deformer, &mesh), "0 points");
  mesh = MakeMesh();
  mesh.points = NULL;
  REFUSED(dv_set_mesh(deformer, &mesh), "null");
  mesh = MakeMesh();
  mesh.point_type = DV_INT16;
  REFUSED(dv_set_mesh(deformer, &mesh), "DV_FLOAT64");
  mesh = MakeMesh();
  mesh.number_of_cells = 0;
  REFUSED(dv_set_mesh(deformer, &mesh), "no cells");
  mesh.number_of_cells = -3;
  REFUSED(dv_set_mesh(deformer, &mesh), "-3");
  mesh = MakeMesh();
  mesh.connectivity = NULL;
  REFUSED(dv_set_mesh(deformer, &mesh), "null");
  mesh = MakeMesh();
  Tetrahedra[3][2] = 8;
  REFUSED(dv_set_mesh(deformer, &mesh), "Cell 3 of the deformation mesh uses point 8");
  Tetrahedra[3][2] = -1;
  REFUSED(dv_set_mesh(deformer, &mesh), "uses point -1");
  Tetrahedra[3][2] = 4;
  mesh.offsets = offsets;
  mesh.types = types;
  CHECK(dv_set_mesh(deformer, &mesh) == DV_OK);
  /* A program that was compiled with an older header: members after struct_size are not read. */
  mesh.struct_size = offsetof(dv_mesh, degrees);
  mesh.degrees = (const int32_t*)(size_t)8;
  CHECK(dv_set_mesh(deformer, &mesh) == DV_OK);
  mesh = MakeMesh();
  mesh.offsets = offsets;
  mesh.types = types;
  mesh.offsets = NULL;
  REFUSED(dv_set_mesh(deformer, &mesh), "no offsets");
  mesh.offsets = offsets;
  types[1] = 12;
  REFUSED(dv_set_mesh(deformer, &mesh), "hexahedron with 4 points instead of 8");
  types[1] = 42;
  REFUSED(dv_set_mesh(deformer, &mesh), "incomplete faces");
  mesh.faces = faces;
  for (i = 0; i < 17; ++i)
  {
    mesh.number_of_face_values = i;
    REFUSED(dv_set_mesh(deformer, &mesh), "incomplete faces");
  }
  mesh.number_of_face_values = 17;
  CHECK(dv_set_mesh(deformer, &mesh) == DV_OK);
  faces[16] = 8;
  REFUSED(dv_set_mesh(deformer, &mesh), "uses point 8");
  faces[16] = 7;
  faces[13] = 2147483647;
  REFUSED(dv_set_mesh(deformer, &mesh), "incomplete faces");
  types[1] = 78;
  REFUSED(dv_set_mesh(deformer, &mesh), "Bezier");
  types[0] = types[1] = types[2] = types[3] = types[4] = 9;
  REFUSED(dv_set_mesh(deformer, &mesh), "no tetrahedra, but 5 quad");
  types[0] = types[1] = types[2] = types[3] = types[4] = 10;
  offsets[2] = 7;
  REFUSED(dv_set_mesh(deformer, &mesh), "Cell 1");
  offsets[2] = -8;
  REFUSED(dv_set_mesh(deformer, &mesh), "Cell 1");
  REFUSED(dv_set_displacements(deformer, DV_FLOAT32, 7, Displacements), "8 points");
  REFUSED(dv_set_displacements(deformer, DV_FLOAT32, -1, Displacements), "-1");
  REFUSED(dv_set_displacements(deformer, DV_FLOAT32, 8, NULL), "null");
  REFUSED(dv_set_displacements(deformer, DV_UINT8, 8, Displacements), "DV_FLOAT32");

  /* Displacements and points that are not finite or too large are reported by dv_deform(). */
  Displacements[6][1] = (float)(infinity - infinity);
  CHECK(dv_set_displacements(deformer, DV_FLOAT32, 8, Displacements) == DV_OK);
  REFUSED(dv_deform(deformer, &request, NULL), "Displacement 6");
  Displacements[6][1] = 1e9F;
  CHECK(dv_set_displacements(deformer, DV_FLOAT32, 8, Displacements) == DV_OK);
  REFUSED(dv_deform(deformer, &request, NULL), "16,383");
  Displacements[6][1] = 0.0F;
  CHECK(dv_set_displacements(deformer, DV_FLOAT32, 8, Displacements) == DV_OK);
  CHECK(dv_deform(deformer, &request, NULL) == DV_OK);
  mesh = MakeMesh();
  Corners[4][0] = infinity;
  CHECK(dv_set_mesh(deformer, &mesh) == DV_OK);
  CHECK(dv_set_displacements(deformer, DV_FLOAT32, 8, Displacements) == DV_OK);
  REFUSED(dv_deform(deformer, &request, NULL), "Point 4");
  Corners[4][0] = 0.0;
  CHECK(dv_set_mesh(deformer, &mesh) == DV_OK);
  CHECK(dv_set_displacements(deformer, DV_FLOAT32, 8, Displacements) == DV_OK);

  /* Fields. */
  grid = MakeCube(SIZE);
  memset(&field, 0, sizeof(field));
  REFUSED(dv_set_field(deformer, &field), "struct_size");
  field.struct_size = offsetof(dv_field, undefined); /* of an older header */
  field.type = DV_FLOAT32;
  REFUSED(dv_set_field(deformer, &field), "grid of the field is null");
  field.grid = &grid;
  REFUSED(dv_set_field(deformer, &field), "vectors of the field is null");
  field.vectors = Values;
  field.type = DV_INT16;
  REFUSED(dv_set_field(deformer, &field), "DV_FLOAT32");
  CHECK(dv_deform(deformer, &request, NULL) == DV_OK); /* The mesh is still the deformation. */

  /* Masks. */
  REFUSED(dv_set_smooth_cut(deformer, (const uint8_t*)Coverage, NULL), "both, or none");

  /* Settings. */
  REFUSED(dv_set_outside(deformer, 3, 0.0), "outside mode is 3");
  REFUSED(dv_set_outside(deformer, DV_OUTSIDE_KEEP, -1.0), "-1");
  REFUSED(dv_set_outside(deformer, DV_OUTSIDE_KEEP, infinity - infinity), "fade distance");
  memset(&output, 0, sizeof(output));
  REFUSED(dv_set_output(deformer, &output), "struct_size");
  output.struct_size = sizeof(output);
  output.bounds_mode = 3;
  REFUSED(dv_set_output(deformer, &output), "bounds mode is 3");
  output.bounds_mode = DV_BOUNDS_VOLUME;
  output.spacing[0] = 1.0;
  REFUSED(dv_set_output(deformer, &output), "output spacing");
  output.spacing[0] = 0.0;
  output.padding = 2147483647;
  REFUSED(dv_set_output(deformer, &output), "padding");
  output.padding = 0;
  output.bounds_mode = DV_BOUNDS_CUSTOM;
  output.custom_bounds[0] = 1.0;
  CHECK(dv_set_output(deformer, &output) == DV_OK);
  REFUSED(dv_deform(deformer, &request, NULL), "no box on axis x");
  output.bounds_mode = DV_BOUNDS_VOLUME;
  CHECK(dv_set_output(deformer, &output) == DV_OK);

  /* Requests. */
  request.number_of_outputs = 0;
  REFUSED(dv_deform(deformer, &request, NULL), "room for 0 arrays");
  request.number_of_outputs = -1;
  REFUSED(dv_deform(deformer, &request, NULL), "-1");
  request = MakeRequest();
  request.outputs = NULL;
  REFUSED(dv_deform(deformer, &request, NULL), "null");
  request.outputs = nothing;
  REFUSED(dv_deform(deformer, &request, NULL), "Output 0 is null");
  request = MakeRequest();
  request.coverage = NULL;
  REFUSED(dv_deform(deformer, &request, NULL), "coverage is null");
  request = MakeRequest();
  request.interpolation = 3;
  REFUSED(dv_deform(deformer, &request, NULL), "interpolation is 3");
  request = MakeRequest();
  request.use_extent = 1;
  request.extent[0] = 1;
  REFUSED(dv_deform(deformer, &request, NULL), "is empty");
  request.extent[0] = 0;
  request.extent[5] = SIZE;
  REFUSED(dv_deform(deformer, &request, NULL), "not within that of the output");
  request = MakeRequest();
  request.incremental = 1;
  request.fold_count = (uint32_t*)malloc(sizeof(uint32_t) * VOXELS);
  REFUSED(dv_deform(deformer, &request, NULL), "incremental");
  free(request.fold_count);
  request = MakeRequest();
  CHECK(dv_set_memory_limit(deformer, 1) == DV_OK);
  REFUSED(dv_deform(deformer, &request, NULL), "memory");
  CHECK(dv_set_memory_limit(deformer, 0) == DV_OK);
  CHECK(dv_deform(deformer, &request, NULL) == DV_OK);
  dv_destroy(deformer);
}

/* Counts calls of progress. AbortAt: the number of the call that aborts, or -1 for none. */
struct Progress
{
  int Calls;
  int AbortAt;
  double Last;
};

static int32_t TakeProgress(double fraction, void* user)
{
  struct Progress* progress = (struct Progress*)user;
  CHECK(fraction >= progress->Last && fraction <= 1.0);
  progress->Last = fraction;
  return progress->Calls++ == progress->AbortAt;
}

static void TestProgress(void)
{
  dv_deformer* deformer = MakeDeformer();
  dv_request request = MakeRequest();
  struct Progress progress = { 0, -1, 0.0 };
  int calls = 0;
  int i = 0;
  int16_t expected[VOXELS];
  request.progress = TakeProgress;
  request.user = &progress;
  CHECK(dv_deform(deformer, &request, NULL) == DV_OK);
  CHECK(progress.Last == 1.0);
  calls = progress.Calls;
  /* At 1 the result of the callback is ignored. */
  progress.Calls = 0;
  progress.Last = 0.0;
  CHECK(dv_deform(deformer, &request, NULL) == DV_OK);
  progress.AbortAt = progress.Calls - 1;
  progress.Calls = 0;
  progress.Last = 0.0;
  CHECK(dv_deform(deformer, &request, NULL) == DV_OK);
  CHECK(progress.Calls == progress.AbortAt + 1);
  progress.AbortAt = -1;
  memcpy(expected, Output, sizeof(expected));
  for (i = 0; i < calls - 1; ++i)
  {
    dv_deformer* other = MakeDeformer();
    progress.Calls = 0;
    progress.AbortAt = i;
    progress.Last = 0.0;
    CHECK(dv_deform(other, &request, NULL) == DV_ABORTED);
    CHECK(progress.Calls == i + 1);
    /* The next call without an abort gives the whole output. */
    progress.AbortAt = -1;
    progress.Last = 0.0;
    memset(Output, 0, sizeof(Output));
    CHECK(dv_deform(other, &request, NULL) == DV_OK);
    CHECK(memcmp(Output, expected, sizeof(Output)) == 0);
    dv_destroy(other);
  }
  dv_destroy(deformer);
}

/* Points need no volume. The mesh shears: x grows with z. Without a deformation, points stay. */
static void TestPoints(void)
{
  static const double points[3][3] = { { 1.0, 2.0, 11.0 }, { 4.0, 5.0, 22.0 }, { 1.0, 2.0, 23.0 } };
  double moved[3][3];
  int8_t valid[3] = { -1, -1, -1 };
  const dv_mesh mesh = MakeMesh();
  struct Progress progress = { 0, 0, 0.0 };
  dv_deformer* deformer = NULL;
  dv_points_request request;
  dv_points_report report;
  int i = 0;
  memset(&request, 0, sizeof(request));
  request.struct_size = sizeof(request);
  memset(&report, 0, sizeof(report));
  report.struct_size = sizeof(report);
  CHECK(dv_create(&deformer) == DV_OK);
  CHECK(dv_deform_points(deformer, &request, &report) == DV_OK);
  request.number_of_points = -1;
  REFUSED(dv_deform_points(deformer, &request, &report), "number of points is -1");
  request.number_of_points = 3;
  REFUSED(dv_deform_points(deformer, &request, &report), "The list of points is null");
  request.points = points[0];
  REFUSED(dv_deform_points(deformer, &request, &report), "memory for the moved points is null");
  request.moved = moved[0];
  REFUSED(dv_deform_points(deformer, &request, &report), "memory for the validity");
  request.valid = valid;
  CHECK(dv_deform_points(deformer, &request, NULL) == DV_OK);
  CHECK(memcmp(moved, points, sizeof(moved)) == 0 && valid[2] == 1);

  CHECK(dv_set_mesh(deformer, &mesh) == DV_OK);
  REFUSED(dv_deform_points(deformer, &request, &report), "no displacements");
  CHECK(dv_set_displacements(deformer, DV_FLOAT32, 8, Displacements) == DV_OK);
  CHECK(dv_deform_points(deformer, &request, &report) == DV_OK);
  CHECK(fabs(moved[0][0] - 3.5) < 1e-12 && fabs(moved[1][0] - 9.0) < 1e-12);
  CHECK(fabs(moved[0][1] - 2.0) < 1e-12 && fabs(moved[1][2] - 22.0) < 1e-12);
  CHECK(valid[0] == 1 && valid[1] == 1 && valid[2] == 0);
  CHECK(moved[2][0] == 1.0 && report.number_of_outside_points == 1);
  CHECK(strstr(report.warnings, "1 of 3 points lie outside the mesh") != NULL);
  CHECK(dv_set_outside(deformer, DV_OUTSIDE_EXTRAPOLATE, 0.0) == DV_OK);
  CHECK(dv_deform_points(deformer, &request, &report) == DV_OK);
  CHECK(fabs(moved[2][0] - 1.0 - 5.0 * 23.0 / 22.0) < 1e-12 && valid[2] == 1);
  CHECK(report.warnings[0] == '\0');
  /* Back to rest, in place. */
  request.points = moved[0];
  request.inverse = 1;
  CHECK(dv_deform_points(deformer, &request, &report) == DV_OK);
  for (i = 0; i < 9; ++i)
  {
    CHECK(fabs(moved[i / 3][i % 3] - points[i / 3][i % 3]) < 1e-9);
  }

  request.progress = TakeProgress;
  request.user = &progress;
  CHECK(dv_deform_points(deformer, &request, &report) == DV_ABORTED);
  progress.AbortAt = -1;
  CHECK(dv_deform_points(deformer, &request, &report) == DV_OK && progress.Last == 1.0);
  moved[1][2] = HUGE_VAL;
  REFUSED(dv_deform_points(deformer, &request, &report), "Point 1 is not finite");
  dv_destroy(deformer);
}

/* When the volume becomes larger, densities become smaller. Inverted tetrahedra have no density. */
static void TestDensity(void)
{
  dv_deformer* deformer = MakeDeformer();
  dv_array array = MakeArray();
  dv_request request = MakeRequest();
  dv_report report;
  float displacements[8][3];
  static float densities[VOXELS];
  static float values[VOXELS];
  static double doubles[VOXELS];
  void* outputs[2];
  dv_array both[2];
  int i = 0;
  for (i = 0; i < 8; ++i)
  {
    /* Stretch the volume along x, toward lower indices, so that voxel 11 does not move. */
    displacements[i][0] = i & 1 ? 0.0F : -2.0F * (SIZE - 1);
    displacements[i][1] = displacements[i][2] = 0.0F;
  }
  for (i = 0; i < VOXELS; ++i)
  {
    doubles[i] = 3.0;
  }
  both[0] = both[1] = array;
  both[0].density = 1;
  both[1].data = doubles;
  both[1].type = DV_FLOAT64;
  both[1].density = 1;
  outputs[0] = densities;
  outputs[1] = malloc(sizeof(double) * VOXELS);
  request.number_of_outputs = 2;
  request.outputs = outputs;
  request.incremental = 1;
  report.struct_size = sizeof(report);
  CHECK(dv_set_displacements(deformer, DV_FLOAT32, 8, displacements) == DV_OK);
  CHECK(dv_set_arrays(deformer, 2, both) == DV_OK);
  REFUSED(dv_deform(deformer, &request, NULL), "densities are made of the whole output");
  request.incremental = 0;
  request.interpolation = DV_NEAREST;
  REFUSED(dv_deform(deformer, &request, NULL), "nearest");
  request.interpolation = DV_LINEAR;
  outputs[0] = outputs[1];
  REFUSED(dv_deform(deformer, &request, NULL), "Output 1 has the memory of another output");
  outputs[0] = densities;
  CHECK(dv_deform(deformer, &request, &report) == DV_OK);
  CHECK(report.number_of_covered_voxels > 0 && strcmp(report.warnings, "") == 0);
  for (i = 0; i < VOXELS; ++i)
  {
    CHECK(!Coverage[i] || ((double*)outputs[1])[i] == 1.5);
    CHECK(Coverage[i] || densities[i] == -5.0F);
  }
  /* The same values as floats that are not densities: densities are half of them. */
  array.type = DV_FLOAT32;
  array.data = values;
  for (i = 0; i < VOXELS; ++i)
  {
    values[i] = (float)Values[i];
  }
  both[0] = array;
  outputs[0] = malloc(sizeof(float) * VOXELS);
  CHECK(dv_set_arrays(deformer, 2, both) == DV_OK);
  CHECK(dv_deform(deformer, &request, &report) == DV_OK);
  for (i = 0; i < VOXELS; ++i)
  {
    CHECK(!Coverage[i] || densities[i] == 0.5F * ((float*)outputs[0])[i]);
  }
  /* Invert all tetrahedra. */
  for (i = 0; i < 8; ++i)
  {
    displacements[i][0] = i & 1 ? -2.0F * (SIZE - 1) : 2.0F * (SIZE - 1);
  }
  CHECK(dv_set_displacements(deformer, DV_FLOAT32, 8, displacements) == DV_OK);
  CHECK(dv_deform(deformer, &request, &report) == DV_OK);
  CHECK(strstr(report.warnings, "density arrays have their background there") != NULL);
  CHECK(report.number_of_covered_voxels > 0 && ((double*)outputs[1])[VOXELS / 2] == -5.0);
  free(outputs[0]);
  free(outputs[1]);
  dv_destroy(deformer);
}

/* A part of the output is equal to that of the whole. Memory of the device can be released. */
static void TestParts(void)
{
  dv_deformer* deformer = MakeDeformer();
  dv_request request = MakeRequest();
  dv_report report;
  int16_t whole[VOXELS];
  uint64_t bytes = 0;
  int x = 0;
  int y = 0;
  int z = 0;
  report.struct_size = sizeof(report);
  CHECK(dv_deform(deformer, &request, &report) == DV_OK);
  CHECK(report.number_of_covered_voxels > 0 && report.number_of_covered_voxels < VOXELS);
  CHECK(report.number_of_inverted_tetrahedra == 0);
  CHECK(strcmp(report.warnings, "") == 0 && strchr(report.device, '(') != NULL);
  memcpy(whole, Output, sizeof(whole));
  CHECK(dv_device_memory(deformer, &bytes) == DV_OK && bytes > 0);
  CHECK(dv_release_memory(deformer) == DV_OK);
  CHECK(dv_device_memory(deformer, &bytes) == DV_OK && bytes == 0);
  request.use_extent = 1;
  request.extent[0] = 3;
  request.extent[1] = 7;
  request.extent[2] = 1;
  request.extent[3] = 11;
  request.extent[4] = 5;
  request.extent[5] = 6;
  CHECK(dv_deform(deformer, &request, &report) == DV_OK);
  for (z = 0; z < 2; ++z)
  {
    for (y = 0; y < 11; ++y)
    {
      for (x = 0; x < 5; ++x)
      {
        CHECK(Output[(z * 11 + y) * 5 + x] == whole[((z + 5) * SIZE + y + 1) * SIZE + x + 3]);
      }
    }
  }
  dv_destroy(deformer);
}

/* Runs after the destructors of the library, as it is registered before the library is used. */
static void DeformAtExit(void)
{
  static const int64_t connectivity[8] = { 0, 1, 3, 2, 4, 5, 7, 6 };
  static const int64_t offsets[2] = { 0, 8 };
  static const uint8_t types[1] = { 12 };
  dv_deformer* deformer = MakeDeformer();
  const dv_request request = MakeRequest();
  dv_mesh mesh = MakeMesh();
  mesh.number_of_cells = 1;
  mesh.connectivity = connectivity;
  mesh.offsets = offsets;
  mesh.types = types;
  CHECK(dv_set_mesh(deformer, &mesh) == DV_OK);
  CHECK(dv_set_displacements(deformer, DV_FLOAT32, 8, Displacements) == DV_OK);
  CHECK(dv_deform(deformer, &request, NULL) == DV_OK);
  dv_destroy(deformer);
  if (Failures != 0)
  {
    abort();
  }
}

int main(void)
{
  int i = 0;
  int axis = 0;
  atexit(DeformAtExit);
  Outputs[0] = Output;
  for (i = 0; i < VOXELS; ++i)
  {
    Values[i] = (int16_t)(i * 37 % 1000);
  }
  for (i = 0; i < 8; ++i)
  {
    for (axis = 0; axis < 3; ++axis)
    {
      Corners[i][axis] = 2.0 * (SIZE - 1) * (i >> axis & 1);
    }
    Displacements[i][0] = i >= 4 ? 5.0F : 0.0F;
  }
  TestNull();
  TestMissing();
  TestWrong();
  TestProgress();
  TestPoints();
  TestDensity();
  TestParts();
  printf("%d failures\n", Failures);
  return Failures != 0;
}
