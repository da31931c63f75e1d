/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * ChainMail in C: misuse and error messages, displacements in closed form, and abort.
 * Testing/Cxx/C/TestCChainMail.cxx compares all values with those of vtkChainMailDeformation.
 */
#include "Check.h"
#include "Cube.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum
{
  SIZE = 13,
  VOXELS = SIZE * SIZE * SIZE,
  MIDDLE = (6 * SIZE + 6) * SIZE + 6
};

static dv_chainmail* MakeChainMail(void)
{
  dv_chainmail* chainmail = NULL;
  const dv_grid grid = MakeCube(SIZE);
  CHECK(dv_chainmail_create(&grid, NULL, 0, &chainmail) == DV_OK);
  return chainmail;
}

static dv_chainmail_materials MakeMaterials(void)
{
  dv_chainmail_materials materials;
  memset(&materials, 0, sizeof(materials));
  materials.struct_size = sizeof(materials);
  return materials;
}

/* Moves the middle voxel by 1.5 voxels along x, without relaxation. */
static double Rest[3];
static double Now[3];

static dv_chainmail_request MakeRequest(void)
{
  dv_chainmail_request request;
  memset(&request, 0, sizeof(request));
  Rest[0] = Rest[1] = Rest[2] = Now[1] = Now[2] = 6.0 * Spacing;
  Now[0] = 7.5 * Spacing;
  request.struct_size = sizeof(request);
  request.number_of_handles = 1;
  request.rest_positions = Rest;
  request.positions = Now;
  return request;
}

static const float* GetDisplacements(dv_chainmail* chainmail)
{
  const float* displacements = NULL;
  CHECK(dv_chainmail_displacements(chainmail, &displacements) == DV_OK);
  return displacements;
}

static int AreAllZero(const float* displacements)
{
  int i = 0;
  for (i = 0; i < 3 * VOXELS; ++i)
  {
    if (displacements[i] != 0.0F)
    {
      return 0;
    }
  }
  return 1;
}

static void TestNull(void)
{
  dv_chainmail* chainmail = NULL;
  dv_deformer* deformer = NULL;
  const dv_grid grid = MakeCube(SIZE);
  const dv_chainmail_materials materials = MakeMaterials();
  const dv_chainmail_request request = MakeRequest();
  const float* displacements = NULL;
  uint64_t bytes = 0;
  REFUSED(dv_chainmail_create(&grid, NULL, 0, NULL), "null");
  REFUSED(dv_chainmail_create(NULL, NULL, 0, &chainmail), "the volume is null");
  CHECK(chainmail == NULL);
  REFUSED(dv_chainmail_set_materials(NULL, &materials), "ChainMail is null");
  REFUSED(dv_chainmail_set_pinned(NULL, NULL), "ChainMail is null");
  REFUSED(dv_chainmail_set_active_tetrahedra(NULL, NULL, NULL), "ChainMail is null");
  REFUSED(dv_chainmail_step(NULL, &request, NULL), "ChainMail is null");
  REFUSED(dv_chainmail_reset(NULL), "ChainMail is null");
  REFUSED(dv_chainmail_displacements(NULL, &displacements), "ChainMail is null");
  REFUSED(dv_chainmail_device_memory(NULL, &bytes), "ChainMail is null");
  CHECK(dv_chainmail_device(NULL) == NULL);
  REFUSED(dv_set_chainmail(NULL, NULL), "deformer is null");
  dv_chainmail_destroy(NULL);

  chainmail = MakeChainMail();
  REFUSED(dv_chainmail_set_materials(chainmail, NULL), "the materials is null");
  REFUSED(dv_chainmail_step(chainmail, NULL, NULL), "the request is null");
  REFUSED(dv_chainmail_displacements(chainmail, NULL), "null");
  REFUSED(dv_chainmail_device_memory(chainmail, NULL), "null");
  dv_chainmail_destroy(chainmail);
  CHECK(dv_create(&deformer) == DV_OK);
  REFUSED(dv_set_chainmail(deformer, NULL), "ChainMail is null");
  dv_destroy(deformer);
}

static void TestWrongMaterials(void)
{
  const double nan = HUGE_VAL - HUGE_VAL;
  dv_chainmail* chainmail = MakeChainMail();
  dv_chainmail_materials materials = MakeMaterials();
  dv_array array;
  static uint8_t values[VOXELS];
  static float floats[VOXELS];
  double table[6] = { 0.5, 1.5, 0.5, 0.9, 1.1, 0.1 };
  double ranges[6] = { 0.0, 5.0, 0.0, 5.0, 10.0, 1.0 };
  memset(&array, 0, sizeof(array));
  array.struct_size = sizeof(array);
  array.data = values;
  array.type = DV_UINT8;
  array.components = 1;

  materials.struct_size = 8;
  REFUSED(dv_chainmail_set_materials(chainmail, &materials), "struct_size of the materials is 8");
  materials = MakeMaterials();
  materials.default_material = 5;
  REFUSED(dv_chainmail_set_materials(chainmail, &materials), "default material is 5");
  materials.default_material = -1;
  REFUSED(dv_chainmail_set_materials(chainmail, &materials), "default material is -1");
  materials = MakeMaterials();
  materials.table = table;
  REFUSED(dv_chainmail_set_materials(chainmail, &materials), "0 materials. Give 1 to 256");
  materials.number_of_materials = 257;
  REFUSED(dv_chainmail_set_materials(chainmail, &materials), "257 materials");
  materials.number_of_materials = -2;
  REFUSED(dv_chainmail_set_materials(chainmail, &materials), "materials is -2");
  materials.number_of_materials = 2;
  table[3] = 1.5;
  REFUSED(dv_chainmail_set_materials(chainmail, &materials), "Material 1 has the minimum stretch");
  table[3] = nan;
  REFUSED(dv_chainmail_set_materials(chainmail, &materials), "Material 1 has the minimum stretch");
  table[3] = 0.9;
  table[1] = 0.5;
  REFUSED(dv_chainmail_set_materials(chainmail, &materials), "Material 0 has the maximum stretch");
  table[1] = 1.5;
  table[5] = -1.0;
  REFUSED(dv_chainmail_set_materials(chainmail, &materials), "Material 1 has the shear");
  table[5] = 0.1;

  materials.values = &array;
  array.components = 2;
  REFUSED(dv_chainmail_set_materials(chainmail, &materials), "2 components");
  array.components = 1;
  array.data = NULL;
  REFUSED(dv_chainmail_set_materials(chainmail, &materials), "array of values has no data");
  array.data = values;
  array.type = 99;
  REFUSED(dv_chainmail_set_materials(chainmail, &materials), "type 99");
  array.type = DV_UINT8;
  values[77] = 2;
  REFUSED(dv_chainmail_set_materials(chainmail, &materials), "Voxel 77 has a value");
  values[77] = 1;
  CHECK(dv_chainmail_set_materials(chainmail, &materials) == DV_OK);
  array.data = floats;
  array.type = DV_FLOAT32;
  floats[3] = 0.5F;
  REFUSED(dv_chainmail_set_materials(chainmail, &materials), "Voxel 3 has a value");
  floats[3] = (float)nan;
  REFUSED(dv_chainmail_set_materials(chainmail, &materials), "Voxel 3 has a value");

  materials.number_of_ranges = -1;
  REFUSED(dv_chainmail_set_materials(chainmail, &materials), "ranges of values is -1");
  materials.number_of_ranges = 2;
  REFUSED(dv_chainmail_set_materials(chainmail, &materials), "list of ranges is null");
  materials.ranges = ranges;
  ranges[5] = 2.0;
  REFUSED(dv_chainmail_set_materials(chainmail, &materials), "material of range 1 is 2");
  ranges[5] = 0.5;
  REFUSED(dv_chainmail_set_materials(chainmail, &materials), "material of range 1 is 0.5");
  ranges[5] = nan;
  REFUSED(dv_chainmail_set_materials(chainmail, &materials), "material of range 1");
  ranges[5] = 1.0;
  materials.values = NULL;
  REFUSED(dv_chainmail_set_materials(chainmail, &materials), "values that the ranges are for");
  materials.values = &array;
  /* NaN is a valid value, which is in no range. */
  CHECK(dv_chainmail_set_materials(chainmail, &materials) == DV_OK);
  dv_chainmail_destroy(chainmail);
}

static void TestWrong(void)
{
  const double infinity = HUGE_VAL;
  dv_chainmail* chainmail = NULL;
  dv_grid grid = MakeCube(SIZE);
  dv_chainmail_request request = MakeRequest();
  dv_chainmail_report report;

  grid.extent[3] = 0;
  REFUSED(dv_chainmail_create(&grid, NULL, 0, &chainmail), "one voxel only on axis y");
  grid = MakeCube(SIZE);
  grid.spacing[0] = 0.0;
  REFUSED(dv_chainmail_create(&grid, NULL, 0, &chainmail), "spacing");
  grid = MakeCube(SIZE);
  REFUSED(dv_chainmail_create(&grid, "no such device", 0, &chainmail), "no such device");
  REFUSED(dv_chainmail_create(&grid, NULL, 1, &chainmail), "memory");
  CHECK(chainmail == NULL);

  chainmail = MakeChainMail();
  request.struct_size = 4;
  REFUSED(dv_chainmail_step(chainmail, &request, NULL), "struct_size of the request is 4");
  request = MakeRequest();
  report.struct_size = 0;
  REFUSED(dv_chainmail_step(chainmail, &request, &report), "struct_size of the report is 0");
  request.number_of_handles = -1;
  REFUSED(dv_chainmail_step(chainmail, &request, NULL), "handles is -1");
  request = MakeRequest();
  request.rest_positions = NULL;
  REFUSED(dv_chainmail_step(chainmail, &request, NULL), "rest positions of handles is null");
  request = MakeRequest();
  request.positions = NULL;
  REFUSED(dv_chainmail_step(chainmail, &request, NULL), "positions of handles is null");
  request = MakeRequest();
  Rest[1] = -4.0;
  REFUSED(dv_chainmail_step(chainmail, &request, NULL), "outside the volume");
  Rest[1] = infinity - infinity;
  REFUSED(dv_chainmail_step(chainmail, &request, NULL), "not a finite number");
  request = MakeRequest();
  Now[2] = infinity;
  REFUSED(dv_chainmail_step(chainmail, &request, NULL), "not a finite number");
  Now[2] = 1e5;
  REFUSED(dv_chainmail_step(chainmail, &request, NULL), "more than 4095 voxels");
  request = MakeRequest();
  request.handle_radius = -1.0;
  REFUSED(dv_chainmail_step(chainmail, &request, NULL), "radius");
  request.handle_radius = infinity - infinity;
  REFUSED(dv_chainmail_step(chainmail, &request, NULL), "radius");
  request = MakeRequest();
  request.relaxation_sweeps = -1;
  REFUSED(dv_chainmail_step(chainmail, &request, NULL), "-1 sweeps");
  request = MakeRequest();
  request.elasticity = 1.5;
  REFUSED(dv_chainmail_step(chainmail, &request, NULL), "elasticity");
  request.elasticity = infinity - infinity;
  REFUSED(dv_chainmail_step(chainmail, &request, NULL), "elasticity");
  request = MakeRequest();
  request.plasticity_threshold = -0.1;
  REFUSED(dv_chainmail_step(chainmail, &request, NULL), "plasticity");
  CHECK(AreAllZero(GetDisplacements(chainmail)));
  dv_chainmail_destroy(chainmail);
}

/* The displacement decreases by half a voxel at each link. */
static void TestClosedForm(void)
{
  dv_chainmail* chainmail = MakeChainMail();
  dv_chainmail_request request = MakeRequest();
  dv_chainmail_report report;
  const float* displacements = GetDisplacements(chainmail);
  static uint8_t pinned[VOXELS];
  uint64_t bytes = 0;
  int i = 0;
  int moved = 0;
  CHECK(strchr(dv_chainmail_device(chainmail), '(') != NULL);
  CHECK(dv_chainmail_device_memory(chainmail, &bytes) == DV_OK && bytes >= 27 * VOXELS);
  CHECK(AreAllZero(displacements));
  memset(&report, 0, sizeof(report));
  report.struct_size = sizeof(report);
  CHECK(dv_chainmail_step(chainmail, &request, &report) == DV_OK);
  CHECK(GetDisplacements(chainmail) == displacements);
  for (i = 0; i < VOXELS; ++i)
  {
    const int steps = abs(i % SIZE - 6) + abs(i / SIZE % SIZE - 6) + abs(i / SIZE / SIZE - 6);
    const double expected = steps < 3 ? Spacing * (1.5 - 0.5 * steps) : 0.0;
    moved += expected != 0.0;
    CHECK(displacements[3 * i] == (float)expected);
    CHECK(displacements[3 * i + 1] == 0.0F && displacements[3 * i + 2] == 0.0F);
  }
  CHECK(report.number_of_moved_voxels == moved && report.largest_violation == 0.0);
  CHECK(report.number_of_sweeps > 0 && report.was_reset == 0);
  CHECK(report.number_of_reduced_handles == 0 && report.number_of_released_handles == 0);
  CHECK(report.changed_extent[0] <= 4 && report.changed_extent[1] >= 8);

  /* A pinned voxel does not move, and reduces the motion of the handle. Without handles the
   * relaxation continues. */
  CHECK(dv_chainmail_reset(chainmail) == DV_OK);
  pinned[MIDDLE + 2] = 1;
  CHECK(dv_chainmail_set_pinned(chainmail, pinned) == DV_OK);
  CHECK(dv_chainmail_step(chainmail, &request, &report) == DV_OK);
  CHECK(report.was_reset == 1 && report.number_of_reduced_handles == 1);
  CHECK(displacements[3 * MIDDLE] == (float)Spacing);
  CHECK(displacements[3 * (MIDDLE + 2)] == 0.0F);
  CHECK(dv_chainmail_set_pinned(chainmail, NULL) == DV_OK);
  request.number_of_handles = 0;
  request.relaxation_sweeps = 5;
  request.elasticity = 1.0;
  CHECK(dv_chainmail_step(chainmail, &request, &report) == DV_OK);
  CHECK(displacements[3 * MIDDLE] > 0.0F && displacements[3 * MIDDLE] < (float)Spacing);
  CHECK(report.number_of_moved_voxels > 0 && report.number_of_sweeps >= 5);
  dv_chainmail_destroy(chainmail);
}

static int32_t Abort(double fraction, void* user)
{
  CHECK(fraction == 0.0);
  return ++*(int*)user == 2;
}

static void TestAbort(void)
{
  dv_chainmail* chainmail = MakeChainMail();
  dv_chainmail_request request = MakeRequest();
  int calls = 0;
  request.relaxation_sweeps = 20;
  request.elasticity = 1.0;
  request.progress = Abort;
  request.user = &calls;
  CHECK(dv_chainmail_step(chainmail, &request, NULL) == DV_ABORTED);
  CHECK(calls == 2);
  CHECK(AreAllZero(GetDisplacements(chainmail)));
  request.progress = NULL;
  CHECK(dv_chainmail_step(chainmail, &request, NULL) == DV_OK);
  CHECK(GetDisplacements(chainmail)[3 * MIDDLE] == (float)(1.5 * Spacing));
  dv_chainmail_destroy(chainmail);
}

int main(void)
{
  TestNull();
  TestWrongMaterials();
  TestWrong();
  TestClosedForm();
  TestAbort();
  printf("%d failures\n", Failures);
  return Failures != 0;
}
