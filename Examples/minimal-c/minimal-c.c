/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Deforms an array by a tetrahedral mesh, in C: a volume of 64 x 64 x 64 voxels of 0.5 mm is
 * sheared, by 8 mm along x from its lowest slice to its highest one.
 */
#include <deformvolume.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define SIZE 64

/* Exits the program if a function has failed. */
static void Check(int32_t status)
{
  if (status != DV_OK)
  {
    fprintf(stderr, "%s\n", status == DV_ERROR ? dv_last_error() : "aborted");
    exit(EXIT_FAILURE);
  }
}

/* A return value other than 0 would abort dv_deform(). */
static int32_t ShowProgress(double fraction, void* user)
{
  *(double*)user = fraction;
  return 0;
}

int main(void)
{
  static const int64_t tetrahedra[5][4] = { { 0, 1, 2, 4 }, { 3, 2, 1, 7 }, { 5, 4, 7, 1 },
    { 6, 7, 4, 2 }, { 1, 2, 4, 7 } };
  const double spacing = 0.5;
  double corners[8][3];
  double displacements[8][3];
  dv_deformer* deformer = NULL;
  dv_grid grid;
  dv_grid output;
  dv_array array;
  dv_mesh mesh;
  dv_request request;
  dv_report report;
  double progress = 0.0;
  float* volume = (float*)malloc(sizeof(float) * SIZE * SIZE * SIZE);
  void* values = NULL;
  int8_t* coverage = NULL;
  size_t voxels = 1;
  size_t there = 0;
  size_t i = 0;
  int axis = 0;
  int fits = 0;

  if (!volume)
  {
    return EXIT_FAILURE;
  }
  for (i = 0; i < (size_t)SIZE * SIZE * SIZE; ++i)
  {
    volume[i] = (float)(i % SIZE); /* the x index; x varies fastest */
  }
  /* The corners of the volume at rest, and how far each one moves. */
  for (i = 0; i < 8; ++i)
  {
    for (axis = 0; axis < 3; ++axis)
    {
      corners[i][axis] = spacing * (SIZE - 1) * (double)(i >> axis & 1);
      displacements[i][axis] = axis == 0 && i >= 4 ? 8.0 : 0.0;
    }
  }

  Check(dv_create(&deformer));
  memset(&grid, 0, sizeof(grid));
  grid.struct_size = sizeof(grid);
  for (axis = 0; axis < 3; ++axis)
  {
    grid.extent[2 * axis + 1] = SIZE - 1;
    grid.spacing[axis] = spacing;
    grid.direction[4 * axis] = 1.0;
  }
  Check(dv_set_volume(deformer, &grid));

  memset(&array, 0, sizeof(array));
  array.struct_size = sizeof(array);
  array.data = volume;
  array.type = DV_FLOAT32;
  array.components = 1;
  array.background = -1.0;
  Check(dv_set_arrays(deformer, 1, &array));

  memset(&mesh, 0, sizeof(mesh));
  mesh.struct_size = sizeof(mesh);
  mesh.number_of_points = 8;
  mesh.points = corners;
  mesh.point_type = DV_FLOAT64;
  mesh.number_of_cells = 5;
  mesh.connectivity = tetrahedra[0];
  Check(dv_set_mesh(deformer, &mesh));
  /* Repeat this and all following calls whenever the mesh has moved. */
  Check(dv_set_displacements(deformer, DV_FLOAT64, 8, displacements));

  output.struct_size = sizeof(output);
  Check(dv_output_grid(deformer, &output));
  for (axis = 0; axis < 3; ++axis)
  {
    voxels *= (size_t)(output.extent[2 * axis + 1] - output.extent[2 * axis] + 1);
  }
  values = malloc(voxels * sizeof(float));
  coverage = (int8_t*)malloc(voxels);
  if (!values || !coverage)
  {
    return EXIT_FAILURE;
  }

  memset(&request, 0, sizeof(request));
  request.struct_size = sizeof(request);
  request.number_of_outputs = 1;
  request.outputs = &values;
  request.coverage = coverage;
  request.progress = ShowProgress;
  request.user = &progress;
  report.struct_size = sizeof(report);
  Check(dv_deform(deformer, &request, &report));
  printf("%s\n%ld voxels covered\n%s", report.device, (long)report.number_of_covered_voxels,
    report.warnings);

  /* The middle of the highest slice has moved by 16 voxels. */
  there =
    ((size_t)(SIZE - 1 - output.extent[4]) * (size_t)(output.extent[3] - output.extent[2] + 1) +
      (size_t)(32 - output.extent[2])) *
      (size_t)(output.extent[1] - output.extent[0] + 1) +
    (size_t)(32 + 16 - output.extent[0]);
  fits = coverage[there] == 1 && fabs(((float*)values)[there] - 32.0) < 0.01 && progress == 1.0;

  dv_destroy(deformer);
  free(volume);
  free(values);
  free(coverage);
  return fits ? EXIT_SUCCESS : EXIT_FAILURE;
}
