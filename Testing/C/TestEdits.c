/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Cutting and carving in C: misuse and error messages, undo, and abort.
 * Testing/Cxx/C/TestCEdits.cxx compares all masks and the outputs with those of the filters.
 */
#include "Check.h"
#include "Cube.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* A volume of 11 x 11 x 11 cells. */
enum
{
  SIZE = 12,
  VOXELS = SIZE * SIZE * SIZE,
  CELLS = 11 * 11 * 11
};

static dv_deformer* MakeDeformer(void)
{
  dv_deformer* deformer = NULL;
  const dv_grid grid = MakeCube(SIZE);
  CHECK(dv_create(&deformer) == DV_OK);
  CHECK(dv_set_volume(deformer, &grid) == DV_OK);
  return deformer;
}

static dv_edit MakeEdit(int32_t smooth, int32_t rule)
{
  dv_edit edit;
  memset(&edit, 0, sizeof(edit));
  edit.struct_size = sizeof(edit);
  edit.smooth = smooth;
  edit.rule = rule;
  return edit;
}

static dv_masks GetMasks(dv_deformer* deformer)
{
  dv_masks masks;
  memset(&masks, 0, sizeof(masks));
  masks.struct_size = sizeof(masks);
  CHECK(dv_get_masks(deformer, &masks) == DV_OK);
  return masks;
}

/* A sheet at x = 4.5 voxels that is larger than the volume. */
static double SheetPoints[4][3];
static const int64_t SheetTriangles[2][3] = { { 0, 1, 2 }, { 0, 2, 3 } };

static dv_surface MakeSheet(void)
{
  dv_surface sheet;
  int i = 0;
  for (i = 0; i < 4; ++i)
  {
    SheetPoints[i][0] = 4.5 * Spacing;
    SheetPoints[i][1] = i == 1 || i == 2 ? 100.0 : -100.0;
    SheetPoints[i][2] = i >= 2 ? 100.0 : -100.0;
  }
  memset(&sheet, 0, sizeof(sheet));
  sheet.struct_size = sizeof(sheet);
  sheet.number_of_points = 4;
  sheet.points = SheetPoints;
  sheet.point_type = DV_FLOAT64;
  sheet.number_of_triangles = 2;
  sheet.triangles = SheetTriangles[0];
  return sheet;
}

/* A box from voxel 3 to voxel 7 on each axis. */
static float BoxPoints[8][3];
static const int64_t BoxTriangles[12][3] = { { 0, 1, 3 }, { 0, 3, 2 }, { 4, 5, 7 }, { 4, 7, 6 },
  { 0, 1, 5 }, { 0, 5, 4 }, { 2, 3, 7 }, { 2, 7, 6 }, { 0, 2, 6 }, { 0, 6, 4 }, { 1, 3, 7 },
  { 1, 7, 5 } };

static dv_surface MakeBox(void)
{
  dv_surface box;
  int i = 0;
  int axis = 0;
  for (i = 0; i < 8; ++i)
  {
    for (axis = 0; axis < 3; ++axis)
    {
      BoxPoints[i][axis] = (float)((i >> axis & 1 ? 7.0 : 3.0) * Spacing);
    }
  }
  memset(&box, 0, sizeof(box));
  box.struct_size = sizeof(box);
  box.number_of_points = 8;
  box.points = BoxPoints;
  box.point_type = DV_FLOAT32;
  box.number_of_triangles = 12;
  box.triangles = BoxTriangles[0];
  return box;
}

/* The half-space below x = 4.5 voxels. user: the number of points is added to this int64_t. */
static void FindHalfSpace(int64_t count, const double* points, double* values, void* user)
{
  int64_t i = 0;
  *(int64_t*)user += count;
  for (i = 0; i < count; ++i)
  {
    values[i] = points[3 * i] - 4.5 * Spacing;
  }
}

static dv_body MakeBody(int64_t* count)
{
  dv_body body;
  memset(&body, 0, sizeof(body));
  body.struct_size = sizeof(body);
  body.values = FindHalfSpace;
  body.user = count;
  return body;
}

static void TestNull(void)
{
  dv_deformer* deformer = NULL;
  const dv_surface sheet = MakeSheet();
  const double center[3] = { 0.0, 0.0, 0.0 };
  dv_masks masks;
  masks.struct_size = sizeof(masks);
  REFUSED(dv_cut(NULL, &sheet, NULL), "deformer is null");
  REFUSED(dv_carve_surface(NULL, &sheet, NULL), "deformer is null");
  REFUSED(dv_carve_sphere(NULL, 1, center, 1.0, NULL), "deformer is null");
  REFUSED(dv_carve_label(NULL, NULL, 1.0, NULL), "deformer is null");
  REFUSED(dv_carve_function(NULL, NULL, NULL), "deformer is null");
  REFUSED(dv_undo_edit(NULL), "deformer is null");
  REFUSED(dv_redo_edit(NULL), "deformer is null");
  REFUSED(dv_reset_edits(NULL), "deformer is null");
  REFUSED(dv_get_masks(NULL, &masks), "deformer is null");

  CHECK(dv_create(&deformer) == DV_OK);
  REFUSED(dv_cut(deformer, &sheet, NULL), "no volume");
  REFUSED(dv_carve_sphere(deformer, 1, center, 1.0, NULL), "no volume");
  REFUSED(dv_undo_edit(deformer), "no edit to be undone");
  REFUSED(dv_redo_edit(deformer), "no edit to be redone");
  CHECK(dv_reset_edits(deformer) == DV_OK);
  dv_destroy(deformer);

  deformer = MakeDeformer();
  REFUSED(dv_cut(deformer, NULL, NULL), "the sheet is null");
  REFUSED(dv_carve_surface(deformer, NULL, NULL), "the surface is null");
  REFUSED(dv_carve_sphere(deformer, 1, NULL, 1.0, NULL), "centers of the sphere is null");
  REFUSED(dv_carve_label(deformer, NULL, 1.0, NULL), "the labels is null");
  REFUSED(dv_carve_function(deformer, NULL, NULL), "the body is null");
  REFUSED(dv_get_masks(deformer, NULL), "the masks is null");
  dv_destroy(deformer);
}

static void TestWrong(void)
{
  const double infinity = HUGE_VAL;
  const double nan = infinity - infinity;
  dv_deformer* deformer = MakeDeformer();
  dv_surface sheet = MakeSheet();
  dv_surface box = MakeBox();
  dv_edit edit = MakeEdit(0, DV_CARVE_CENTROID);
  dv_body body;
  dv_array labels;
  dv_masks masks;
  static uint8_t values[VOXELS];
  int64_t wrong[3] = { 0, 1, 4 };
  int64_t count = 0;
  double centers[6] = { 4.0, 4.0, 4.0, 8.0, 4.0, 4.0 };

  /* Sizes of structures. */
  sheet.struct_size = 8;
  REFUSED(dv_cut(deformer, &sheet, NULL), "struct_size of the sheet is 8");
  edit.struct_size = 0;
  sheet = MakeSheet();
  REFUSED(dv_cut(deformer, &sheet, &edit), "struct_size of the edit is 0");
  masks.struct_size = 1;
  REFUSED(dv_get_masks(deformer, &masks), "struct_size of the masks is 1");

  /* Options. */
  edit = MakeEdit(0, 3);
  REFUSED(dv_carve_surface(deformer, &box, &edit), "rule is 3");
  edit = MakeEdit(0, -1);
  REFUSED(dv_carve_surface(deformer, &box, &edit), "rule is -1");

  /* Sheets. */
  sheet.point_type = DV_INT16;
  REFUSED(dv_cut(deformer, &sheet, NULL), "DV_FLOAT64");
  sheet = MakeSheet();
  sheet.points = NULL;
  REFUSED(dv_cut(deformer, &sheet, NULL), "points of the sheet is null");
  sheet.number_of_points = 0;
  REFUSED(dv_cut(deformer, &sheet, NULL), "there are 0 points");
  sheet.number_of_points = -1;
  REFUSED(dv_cut(deformer, &sheet, NULL), "points of the sheet is -1");
  sheet = MakeSheet();
  sheet.number_of_triangles = 0;
  REFUSED(dv_cut(deformer, &sheet, NULL), "no triangles in the sheet");
  sheet.number_of_triangles = -2;
  REFUSED(dv_cut(deformer, &sheet, NULL), "triangles of the sheet is -2");
  sheet = MakeSheet();
  sheet.triangles = NULL;
  REFUSED(dv_cut(deformer, &sheet, NULL), "triangles of the sheet is null");
  sheet.triangles = wrong;
  sheet.number_of_triangles = 1;
  REFUSED(dv_cut(deformer, &sheet, NULL), "has point 4, but there are 4");
  wrong[2] = -1;
  REFUSED(dv_cut(deformer, &sheet, NULL), "has point -1");
  sheet = MakeSheet();
  SheetPoints[2][1] = nan;
  REFUSED(dv_cut(deformer, &sheet, NULL), "Point 2");
  SheetPoints[2][1] = infinity;
  REFUSED(dv_cut(deformer, &sheet, NULL), "Point 2");
  sheet = MakeSheet();

  /* Surfaces. */
  REFUSED(dv_carve_surface(deformer, &sheet, NULL), "is open");
  box.number_of_triangles = 11;
  REFUSED(dv_carve_surface(deformer, &box, NULL), "is open");
  box.number_of_triangles = 0;
  REFUSED(dv_carve_surface(deformer, &box, NULL), "no triangles in the surface");
  box = MakeBox();
  BoxPoints[5][0] = (float)nan;
  REFUSED(dv_carve_surface(deformer, &box, NULL), "Point 5");

  /* Spheres. */
  REFUSED(dv_carve_sphere(deformer, 0, centers, 1.0, NULL), "no position");
  REFUSED(dv_carve_sphere(deformer, -1, centers, 1.0, NULL), "-1");
  REFUSED(dv_carve_sphere(deformer, 2, centers, 0.0, NULL), "radius");
  REFUSED(dv_carve_sphere(deformer, 2, centers, -1.0, NULL), "radius");
  REFUSED(dv_carve_sphere(deformer, 2, centers, nan, NULL), "radius");
  centers[4] = nan;
  REFUSED(dv_carve_sphere(deformer, 2, centers, 1.0, NULL), "not finite");

  /* Labels. */
  memset(&labels, 0, sizeof(labels));
  REFUSED(dv_carve_label(deformer, &labels, 1.0, NULL), "struct_size of the labels is 0");
  labels.struct_size = sizeof(labels);
  labels.type = DV_UINT8;
  labels.components = 1;
  REFUSED(dv_carve_label(deformer, &labels, 1.0, NULL), "labels has no data");
  labels.data = values;
  REFUSED(dv_carve_label(deformer, &labels, 1.0, NULL), "No voxel has the label 1");
  REFUSED(dv_carve_label(deformer, &labels, nan, NULL), "No voxel has the label");
  labels.components = 2;
  REFUSED(dv_carve_label(deformer, &labels, 0.0, NULL), "2 components");
  labels.components = 1;
  labels.type = 10;
  REFUSED(dv_carve_label(deformer, &labels, 0.0, NULL), "type 10");

  /* Functions. */
  body = MakeBody(&count);
  body.values = NULL;
  REFUSED(dv_carve_function(deformer, &body, NULL), "no function of values");
  body = MakeBody(&count);
  body.bounds[3] = -1.0;
  REFUSED(dv_carve_function(deformer, &body, NULL), "bounds of the body on axis y");
  body.bounds[3] = nan;
  REFUSED(dv_carve_function(deformer, &body, NULL), "bounds of the body on axis y");
  body = MakeBody(&count);
  body.struct_size = 16;
  REFUSED(dv_carve_function(deformer, &body, NULL), "struct_size of the body is 16");
  CHECK(count == 0);

  /* None of these errors has changed the masks. */
  masks = GetMasks(deformer);
  CHECK(masks.active == NULL && masks.boundary_distances == NULL && masks.crossed == NULL);
  CHECK(masks.number_of_edits == 0 && masks.number_of_switched_off_tetrahedra == 0);
  dv_destroy(deformer);
}

/* Undo and redo change the masks. Edits are kept for the same grid, and removed for another grid.
 */
static void TestHistory(void)
{
  dv_deformer* deformer = MakeDeformer();
  const dv_surface sheet = MakeSheet();
  const dv_surface box = MakeBox();
  static const uint8_t none[CELLS];
  dv_grid grid = MakeCube(SIZE);
  CHECK(dv_cut(deformer, &sheet, NULL) == DV_OK);
  CHECK(dv_carve_surface(deformer, &box, NULL) == DV_OK);
  CHECK(GetMasks(deformer).number_of_edits == 2);
  CHECK(dv_undo_edit(deformer) == DV_OK);
  CHECK(GetMasks(deformer).number_of_edits == 1);
  CHECK(GetMasks(deformer).number_of_undone_edits == 1);
  CHECK(GetMasks(deformer).number_of_switched_off_tetrahedra == 11 * 11 * 5);
  CHECK(dv_undo_edit(deformer) == DV_OK);
  CHECK(GetMasks(deformer).active == NULL);
  REFUSED(dv_undo_edit(deformer), "no edit to be undone");
  CHECK(dv_redo_edit(deformer) == DV_OK);
  CHECK(GetMasks(deformer).number_of_switched_off_tetrahedra == 11 * 11 * 5);
  CHECK(dv_set_volume(deformer, &grid) == DV_OK);
  CHECK(GetMasks(deformer).number_of_edits == 1);
  CHECK(dv_reset_edits(deformer) == DV_OK);
  REFUSED(dv_redo_edit(deformer), "no edit to be redone");
  CHECK(dv_set_active_tetrahedra(deformer, none) == DV_OK);
  CHECK(GetMasks(deformer).active == none);
  CHECK(dv_set_active_tetrahedra(deformer, NULL) == DV_OK);
  CHECK(dv_cut(deformer, &sheet, NULL) == DV_OK);
  grid.origin[0] = 1.0;
  CHECK(dv_set_volume(deformer, &grid) == DV_OK);
  CHECK(GetMasks(deformer).active == NULL && GetMasks(deformer).number_of_edits == 0);
  dv_destroy(deformer);
}

/* A function is not called for bodies outside the volume. Labels have 64 bits. */
static void TestBodies(void)
{
  dv_deformer* deformer = MakeDeformer();
  const dv_edit minimal = MakeEdit(0, DV_CARVE_MINIMAL);
  static int64_t labels[VOXELS];
  dv_array array;
  int64_t count = 0;
  dv_body body = MakeBody(&count);
  int i = 0;
  CHECK(dv_carve_function(deformer, &body, &minimal) == DV_OK);
  CHECK(GetMasks(deformer).number_of_switched_off_tetrahedra == 4 * 11 * 11 * 5);
  CHECK(count > 0);
  CHECK(dv_reset_edits(deformer) == DV_OK);
  count = 0;
  body.bounds[0] = body.bounds[2] = body.bounds[4] = -9.0;
  body.bounds[1] = body.bounds[3] = body.bounds[5] = -8.0;
  CHECK(dv_carve_function(deformer, &body, NULL) == DV_OK);
  CHECK(count == 0 && GetMasks(deformer).number_of_switched_off_tetrahedra == 0);

  /* Voxels up to index 4 on x: 4 layers of cells. */
  for (i = 0; i < VOXELS; ++i)
  {
    labels[i] = i % SIZE <= 4 ? 9007199254740992 : -3;
  }
  memset(&array, 0, sizeof(array));
  array.struct_size = sizeof(array);
  array.data = labels;
  array.type = DV_INT64;
  array.components = 1;
  CHECK(dv_carve_label(deformer, &array, 9007199254740992.0, &minimal) == DV_OK);
  CHECK(GetMasks(deformer).number_of_switched_off_tetrahedra == 4 * 11 * 11 * 5);
  dv_destroy(deformer);
}

static int32_t Abort(double fraction, void* user)
{
  CHECK(fraction >= 0.0 && fraction <= 1.0);
  ++*(int*)user;
  return 1;
}

static void TestAbort(void)
{
  dv_deformer* deformer = MakeDeformer();
  const dv_surface sheet = MakeSheet();
  const double center[3] = { 11.0, 11.0, 11.0 };
  int calls = 0;
  dv_edit edit = MakeEdit(0, DV_CARVE_CENTROID);
  edit.progress = Abort;
  edit.user = &calls;
  CHECK(dv_cut(deformer, &sheet, &edit) == DV_ABORTED);
  CHECK(calls == 1 && GetMasks(deformer).number_of_edits == 0);
  edit.smooth = 1;
  CHECK(dv_cut(deformer, &sheet, &edit) == DV_ABORTED);
  CHECK(dv_carve_sphere(deformer, 1, center, 5.0, &edit) == DV_ABORTED);
  CHECK(calls == 3 && GetMasks(deformer).number_of_edits == 0);
  CHECK(GetMasks(deformer).active == NULL);
  CHECK(dv_cut(deformer, &sheet, NULL) == DV_OK);
  CHECK(GetMasks(deformer).number_of_switched_off_tetrahedra == 11 * 11 * 5);
  dv_destroy(deformer);
}

int main(void)
{
  TestNull();
  TestWrong();
  TestHistory();
  TestBodies();
  TestAbort();
  printf("%d failures\n", Failures);
  return Failures != 0;
}
