/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * @file
 * The C interface of DeformVolume, also for other languages. The library is libdeformvolume.so.
 * All of its names begin with dv_.
 *
 * Errors. Functions that can fail return DV_OK or another status. dv_last_error() then returns a
 * text that says what is wrong and what to do about it. No C++ exception leaves the library.
 *
 * Texts are UTF-8 and end with a zero.
 *
 * Threads. All functions may be called from several threads at once, but not from two threads at
 * once for the same object (deformer, ChainMail). Threads need a stack of 128 KiB.
 *
 * Processes. OpenCL does not work in a process that was forked after the first use of a device:
 * calls that choose a device are errors there, and others may wait forever. Start another program
 * instead, or fork before.
 *
 * Memory. Outputs must not overlap each other, nor data that are borrowed.
 */
#ifndef deformvolume_h
#define deformvolume_h

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C"
{
#endif

/** @def DV_EXPORT
 * Marks a function that the library exports. */
#if defined(_WIN32)
#define DV_EXPORT __declspec(dllexport)
#elif defined(__GNUC__)
#define DV_EXPORT __attribute__((visibility("default")))
#else
#define DV_EXPORT
#endif

/* ---- Versions and errors ---- */

/** The version of this interface. It grows with every change that breaks programs which were
 * compiled before. Changes that only add functions, or members at the end of structures that begin
 * with their size, do not change it. */
#define DV_ABI_VERSION 1

  /** Returns the DV_ABI_VERSION that the library was built with. Programs that load the library at
   * run time compare it with their own before they call any other function. */
  DV_EXPORT int32_t dv_abi_version(void);

  /** Returns the version of DeformVolume, such as "0.2.0". The text is valid as long as the process
   * runs. */
  DV_EXPORT const char* dv_version(void);

  /** The status that functions return. */
  enum
  {
    /** The function succeeded. */
    DV_OK = 0,
    /** The function failed. dv_last_error() returns the reason. */
    DV_ERROR = 1,
    /** A progress callback requested an abort. */
    DV_ABORTED = 2
  };

  /** Returns the reason for the last failure (DV_ERROR) of a function in this thread; an empty text
   * if no function has failed. The text belongs to the library, and is valid until the next failure
   * in this thread. */
  DV_EXPORT const char* dv_last_error(void);

  /* ---- Devices and drivers ---- */

  /** The bits of dv_device_flags(). */
  enum
  {
    /** A CPU device. */
    DV_DEVICE_PROCESSOR = 1,
    /** A software renderer or an interpreter: slow. */
    DV_DEVICE_EMULATED = 2,
    /** The device supports double precision. */
    DV_DEVICE_DOUBLE = 4
  };

  /** Adds an OpenCL driver that the system does not list, such as PoCL from a Python package. path:
   * the absolute path of the driver's library. The library is loaded, and stays loaded. A second
   * call with the same path does nothing. Devices of added drivers come before equal devices of the
   * system. Indices of devices may change. PoCL 3.0 of the Python package pocl-binary-distribution
   * can compile kernels for a processor that does not fit its built-in functions. The function
   * corrects this processor in the memory of PoCL, unless the environment variable
   * DEFORMVOLUME_KERNEL_PROCESSOR is "driver".
   * Fails if the path is not absolute, if the library cannot be loaded or is no OpenCL driver, or
   * if the environment variable has a value other than "auto" and "driver". */
  DV_EXPORT int32_t dv_add_driver(const char* path);

  /** Sets the folder of a program "ld" with which PoCL links kernels. It is used if PoCL was added
   * by dv_add_driver() and the "ld" on the PATH does not work: PoCL would end the process without a
   * working linker. Call the function before a device is used. The environment variable
   * DEFORMVOLUME_LINKER changes the choice: with "system" the program is never used, with "own" it
   * is always used for added drivers. While kernels are compiled, the folder is in the environment
   * variable COMPILER_PATH of this process.
   * Fails if the path is not absolute. */
  DV_EXPORT int32_t dv_set_linker(const char* folder);

  /** Returns the number of OpenCL devices, sorted with the best device first; 0 if there is none.
   * The first call starts the drivers, which may take some tenths of a second. */
  DV_EXPORT int32_t dv_device_count(void);

  /** Returns the name of a device, "device (platform)". index: 0 <= index < dv_device_count().
   * Returns null and sets an error if there is no such device. The text belongs to the library, and
   * is valid until the next call of this function in this thread. */
  DV_EXPORT const char* dv_device_name(int32_t index);

  /** Returns the properties of a device, a sum of DV_DEVICE_... Returns -1 and sets an error if
   * there is no such device. */
  DV_EXPORT int32_t dv_device_flags(int32_t index);

  /* ---- Deforming a volume ---- */

  /**
   * A deformer has one volume with its arrays, one deformation, and the settings of the output.
   * Settings are kept until they are set again: a program sets only what changes, and dv_deform()
   * recomputes only what depends on it.
   *
   * Without a deformation the volume is resampled at rest.
   *
   *   dv_create, dv_set_volume, dv_set_arrays, dv_set_mesh, dv_set_displacements,
   *   dv_output_grid, dv_deform, dv_destroy
   *
   * Coordinates. All points and vectors are in world coordinates, and all lengths in one unit, for
   * instance mm. A grid defines the positions of its points.
   *
   * Memory. Pointers are read during the call only, unless they are documented as borrowed.
   * Borrowed memory must remain valid and unchanged until the same function is called again with
   * other memory, until dv_set_volume() is called with another grid, or until dv_destroy(). If its
   * values change, call the function again. Memory must have the alignment of its type.
   *
   * Structures begin with struct_size, their size in bytes as the program was compiled: set it to
   * sizeof the structure. Members that are not set must be 0. In lists of structures, struct_size
   * of the first structure applies to all.
   *
   * Errors. A function that fails does not change the deformer. If dv_deform() fails, the contents
   * of the output are undefined. The deformer can be used again in any case.
   */
  typedef struct dv_deformer dv_deformer;

  /** Types of the elements of arrays. */
  enum
  {
    DV_INT8 = 0,    /**< int8_t */
    DV_UINT8 = 1,   /**< uint8_t */
    DV_INT16 = 2,   /**< int16_t */
    DV_UINT16 = 3,  /**< uint16_t */
    DV_INT32 = 4,   /**< int32_t */
    DV_UINT32 = 5,  /**< uint32_t */
    DV_INT64 = 6,   /**< int64_t */
    DV_UINT64 = 7,  /**< uint64_t */
    DV_FLOAT32 = 8, /**< float */
    DV_FLOAT64 = 9  /**< double */
  };

  /** A grid of points. The position of the point with index (i, j, k) is
   *   origin + direction * (spacing[0] * i, spacing[1] * j, spacing[2] * k). */
  typedef struct dv_grid
  {
    /** The size of the structure in bytes, set by the program. */
    size_t struct_size;
    /** First and last index on x, y and z, both inclusive. */
    int32_t extent[6];
    /** The position of the index (0, 0, 0), even if the extent does not contain it. */
    double origin[3];
    /** The distance between neighboring points on each axis, not 0. Negative values are allowed. */
    double spacing[3];
    /** A 3 x 3 matrix, row by row. Its columns are the axes. It must be invertible. */
    double direction[9];
  } dv_grid;

  /** An array over the points of a volume. Each tuple has `components` elements; x varies fastest,
   * then y, then z. */
  typedef struct dv_array
  {
    /** The size of the structure in bytes, set by the program. */
    size_t struct_size;
    /** The values. Borrowed. */
    const void* data;
    /** The type of the elements, DV_INT8 to DV_FLOAT64. */
    int32_t type;
    /** The number of elements of a tuple, 1 or more. */
    int32_t components;
    /** Not 0: the values are labels. Labels are never interpolated: each one is copied from one
     * voxel. */
    int32_t categorical;
    /** Not 0: the values are amounts per unit of volume, such as a dose or an activity. Values of
     * the output are divided by the change of volume, so that their sum times the volume of a
     * voxel is preserved. The output has doubles if the type is DV_FLOAT64, otherwise floats.
     * Output voxels at which the volume is inverted get the background. Amounts that folds hide are
     * missing from the sum; the warnings of dv_report give their size. Not allowed with labels,
     * DV_NEAREST or incremental. */
    int32_t density;
    /** The value of output voxels that the deformed volume does not cover, rounded and clamped to
     * the range of the output type. */
    double background;
  } dv_array;

  /** Creates a deformer. Destroy it with dv_destroy(). */
  DV_EXPORT int32_t dv_create(dv_deformer** deformer);
  /** Destroys a deformer. Null is allowed. */
  DV_EXPORT void dv_destroy(dv_deformer* deformer);

  /** Sets the device. name: the name of a device (dv_device_name()) or a part of it; "cpu" or
   * "gpu"; null or "" for the best device, which is the default. Fails if there is no such device.
   */
  DV_EXPORT int32_t dv_set_device(dv_deformer* deformer, const char* name);

  /** Sets the memory that may be used on the device, in bytes. Default 0: all that is available. */
  DV_EXPORT int32_t dv_set_memory_limit(dv_deformer* deformer, uint64_t bytes);

  /** Sets the grid of the volume at rest, with at least two points on each axis. If the grid
   * differs from the previous one, arrays and masks are discarded. For a block of a larger volume,
   * give the extent of the block in that volume: the split of cells into tetrahedra alternates
   * between even and odd indices. */
  DV_EXPORT int32_t dv_set_volume(dv_deformer* deformer, const dv_grid* grid);

  /** Sets the arrays of the volume. Their data are borrowed. count may be 0 if
   * dv_request names rest_positions or jacobian: then dv_deform() writes only what it names. */
  DV_EXPORT int32_t dv_set_arrays(dv_deformer* deformer, int32_t count, const dv_array* arrays);

  /** Sets the blanked voxels. One byte per voxel: not 0 if the voxel is blanked. Null: no voxel is
   * blanked. Borrowed. */
  DV_EXPORT int32_t dv_set_blanked(dv_deformer* deformer, const uint8_t* blanked);

  /* Cuts and carvings. Tetrahedra are those of the implicit mesh between the voxels: five for each
   * cell of eight neighboring voxels (Documents/glossary.md). Arrays of cells have one tuple per
   * cell, and one cell less than voxels on each axis; x varies fastest. vtkCutVolume,
   * vtkCarveVolume and the functions of the section 'Cutting and carving' make these arrays. All of
   * them are borrowed. Null: there is no such mask. */

  /** Sets the active tetrahedra. active: one byte per cell; bit i is set if tetrahedron i is
   * active. Null: all are active. */
  DV_EXPORT int32_t dv_set_active_tetrahedra(dv_deformer* deformer, const uint8_t* active);

  /** Sets the smooth boundary of a carved volume. distances: one float per voxel, its signed
   * distance from the boundary of the carved-out region, negative inside that region, in any unit.
   * Samples with a negative distance are discarded. */
  DV_EXPORT int32_t dv_set_boundary_distances(dv_deformer* deformer, const float* distances);

  /** Sets a smooth cut. crossed: one byte per cell; bit i is set if the sheet crosses tetrahedron
   * i. distances: one float per voxel, its signed distance from the sheet. Give both or none. Not
   * allowed with inverse fields. */
  DV_EXPORT int32_t dv_set_smooth_cut(
    dv_deformer* deformer, const uint8_t* crossed, const float* distances);

  /** A deformation mesh at rest. Types of cells and the order of their points are those of VTK:
   * tetrahedra (10), voxels (11), hexahedra (12), wedges (13), pyramids (14), prisms (15, 16),
   * quadratic cells (24 to 27, 29, 31 to 33, 37), polyhedra (42) and Lagrange cells (71 to 73). All
   * cells are split into tetrahedra between their points. A polyhedron that these tetrahedra would
   * not fill is split around an additional point inside it. Bezier cells are an error. Cells of
   * other types are ignored, with a warning. */
  typedef struct dv_mesh
  {
    /** The size of the structure in bytes, set by the program. */
    size_t struct_size;
    /** The number of points of the mesh. */
    int64_t number_of_points;
    /** Three numbers per point, in world coordinates. */
    const void* points;
    /** The type of points: DV_FLOAT32 or DV_FLOAT64. */
    int32_t point_type;
    /** Must be 0. */
    int32_t reserved;
    /** The number of cells of the mesh. */
    int64_t number_of_cells;
    /** The point numbers of each cell, one cell after the other. */
    const int64_t* connectivity;
    /** The VTK type of each cell. Null: all cells are tetrahedra. The members below are then null,
     * too. */
    const uint8_t* types;
    /** number_of_cells + 1 numbers: the index in connectivity of the first point of each cell, then
     * the end of the last cell. */
    const int64_t* offsets;
    /** Null, or three numbers per cell: the degrees of a Lagrange cell along its axes. The numbers
     * of other cells are ignored. */
    const int32_t* degrees;
    /** The faces of the polyhedra, in the order of the cells. For each polyhedron: the number of
     * its faces, then for each face the number of its points, and its points in order around the
     * face. Null if there are no polyhedra. */
    const int64_t* faces;
    /** The number of values in faces. */
    int64_t number_of_face_values;
  } dv_mesh;

  /** Sets the deformation mesh, which replaces the previous mesh or field. The new mesh has no
   * displacements yet. */
  DV_EXPORT int32_t dv_set_mesh(dv_deformer* deformer, const dv_mesh* mesh);

  /** Sets the displacements of the points of the mesh: count vectors of three numbers, one for each
   * point, in world coordinates. type: DV_FLOAT32 or DV_FLOAT64. If a vector of a point that a cell
   * uses is not finite, or more than 16,383 output voxels on an axis, dv_deform() fails. */
  DV_EXPORT int32_t dv_set_displacements(
    dv_deformer* deformer, int32_t type, int64_t count, const void* displacements);

  /** A displacement field: one vector for each point of its own grid, interpolated linearly. */
  typedef struct dv_field
  {
    /** The size of the structure in bytes, set by the program. */
    size_t struct_size;
    /** The grid of the field. */
    const dv_grid* grid;
    /** Three numbers per point, in world coordinates, x varying fastest. Borrowed. */
    const void* vectors;
    /** The type of vectors: DV_FLOAT32 or DV_FLOAT64. */
    int32_t type;
    /** 0: each vector leads from a point of the volume to its deformed position. Not 0: each vector
     * leads from a point of the output to the point of the volume that appears there. */
    int32_t inverse;
    /** Null, or one byte per point: not 0 if the displacement of the point is unknown, for example
     * where digital volume correlation found no match. Its vector is not read. Voxels whose
     * interpolation would use such a point are not covered. Borrowed. */
    const uint8_t* undefined;
  } dv_field;

  /** Sets the displacement field, which replaces the previous mesh or field. */
  DV_EXPORT int32_t dv_set_field(dv_deformer* deformer, const dv_field* field);

  /** Treatment of voxels outside the mesh or field. */
  enum
  {
    /** They are discarded. */
    DV_OUTSIDE_DISCARD = 0,
    /** They follow the nearest part of the mesh or field. */
    DV_OUTSIDE_EXTRAPOLATE = 1,
    /** They stay at rest. Within fade_distance of the boundary they partly follow it. */
    DV_OUTSIDE_KEEP = 2
  };

  /** Sets the treatment of voxels outside the mesh or field. mode: DV_OUTSIDE_DISCARD (default),
   * DV_OUTSIDE_EXTRAPOLATE or DV_OUTSIDE_KEEP. fade_distance: in world units, 0 or more; used with
   * DV_OUTSIDE_KEEP only. */
  DV_EXPORT int32_t dv_set_outside(dv_deformer* deformer, int32_t mode, double fade_distance);

  /** Sets the grid of the output, such as that of the fixed image of a registration. It may have
   * any extent, spacing and direction, also rotated or mirrored. Null (default): the output has the
   * origin, direction and spacing of the volume, changed by dv_set_output(). */
  DV_EXPORT int32_t dv_set_reference(dv_deformer* deformer, const dv_grid* grid);

  /** The bounds of the output without a reference grid. */
  enum
  {
    /** The bounds of the deformed volume. */
    DV_BOUNDS_DEFORMED = 0,
    /** The bounds of the volume at rest. */
    DV_BOUNDS_VOLUME = 1,
    /** dv_output::custom_bounds. */
    DV_BOUNDS_CUSTOM = 2
  };

  /** The bounds and spacing of the output without a reference grid. */
  typedef struct dv_output
  {
    /** The size of the structure in bytes, set by the program. */
    size_t struct_size;
    /** DV_BOUNDS_DEFORMED, DV_BOUNDS_VOLUME or DV_BOUNDS_CUSTOM. */
    int32_t bounds_mode;
    /** The number of voxels that are added on each side; negative: removed. */
    int32_t padding;
    /** The bounds in world coordinates: x min, x max, y min, y max, z min, z max. */
    double custom_bounds[6];
    /** The spacing, greater than 0. All 0: the spacing of the volume. */
    double spacing[3];
  } dv_output;

  /** Sets the bounds and spacing of the output. Null (default): DV_BOUNDS_DEFORMED, no padding, the
   * spacing of the volume. */
  DV_EXPORT int32_t dv_set_output(dv_deformer* deformer, const dv_output* output);

  /** Gets the grid of the whole output for the current settings, to allocate the memory for
   * dv_deform(). Set grid->struct_size before the call. Fails if the volume or the displacements of
   * a mesh are missing, or if the deformed volume covers no output voxel. */
  DV_EXPORT int32_t dv_output_grid(dv_deformer* deformer, dv_grid* grid);

  /** Interpolation of the values of voxels. */
  enum
  {
    DV_LINEAR = 0, /**< linear in each tetrahedron */
    DV_CUBIC = 1,  /**< Catmull-Rom splines over four voxels on each axis, if these are available */
    DV_NEAREST = 2 /**< none: all arrays are treated as categorical */
  };

  /** A progress callback. fraction: the completed fraction of the work, 0 to 1. user: the pointer
   * that was given with the callback. It is called in the thread that called the library. Return 0
   * to continue; otherwise the library function aborts and returns DV_ABORTED. The callback must
   * neither throw nor call functions for the same object. */
  typedef int32_t (*dv_progress)(double fraction, void* user);

  /** The input of dv_deform(), and the memory that it writes during the call. */
  typedef struct dv_request
  {
    /** The size of the structure in bytes, set by the program. */
    size_t struct_size;
    /** A part of the whole extent of the output, in indices of the output. */
    int32_t extent[6];
    /** 0: extent is ignored, and the whole output is computed. */
    int32_t use_extent;
    /** DV_LINEAR, DV_CUBIC or DV_NEAREST. */
    int32_t interpolation;
    /** The number of outputs: that of the arrays of dv_set_arrays(). */
    int32_t number_of_outputs;
    /** Not 0: this call and the next one may be parts of a sequence. If the next call is
     * incremental, too, and has the same extent and memory, it writes only what has changed; the
     * memory must still hold what this call wrote. Results are bit for bit the same. Not allowed
     * with rest_positions, jacobian, fold_count or densities. */
    int32_t incremental;
    /** For each array, memory for its tuples at all output voxels, with the type of the array. For
     * densities see dv_array::density. */
    void* const* outputs;
    /** Memory for one byte per voxel: 1 if the deformed volume covers it, otherwise 0. */
    int8_t* coverage;
    /** Null, or memory for three floats per voxel: the world coordinates at rest of the tissue that
     * appears there. */
    float* rest_positions;
    /** Null, or memory for one float per voxel: the Jacobian determinant, by which the deformation
     * multiplies volumes there; negative if the volume is inverted. */
    float* jacobian;
    /** Null, or memory for one integer per voxel: the number of tetrahedra of the sampling mesh
     * that contain it; more than 1 in folds. With inverse fields it is 1 at each covered voxel and
     * does not show folds: the Jacobian is negative there. */
    uint32_t* fold_count;
    /** The value of rest_positions and jacobian at voxels that are not covered. */
    double extra_background;
    /** The progress callback; null: none. Its fraction does not decrease. At 1 the work is done,
     * and the result of the callback is ignored. */
    dv_progress progress;
    /** The argument `user` of the callback. */
    void* user;
  } dv_request;

  /** The results of dv_deform() besides the output. */
  typedef struct dv_report
  {
    /** The size of the structure in bytes, set by the program. */
    size_t struct_size;
    /** The number of output voxels that the deformed volume covers. */
    int64_t number_of_covered_voxels;
    /** The number of tetrahedra that the deformation inverts: of the sampling mesh or, with an
     * inverse field, of the grid of the field. */
    int64_t number_of_inverted_tetrahedra;
    /** The number of tetrahedra of the mesh that have no volume at rest. */
    int64_t number_of_flat_tetrahedra;
    /** The number of cells of the volume that are stretched over more than 4,000 output voxels.
     * Their overstretched tetrahedra are discarded. */
    int64_t number_of_overstretched_cells;
    /** The number of samples that other parts of a folded volume hide. 0 if an incremental call
     * has written only what has changed. */
    int64_t number_of_hidden_samples;
    /** An extent that contains all output voxels that may have changed since the last call. Empty
     * (first > last) if no voxel has changed. */
    int32_t changed_extent[6];
    /** The name of the device. The text belongs to the deformer, and is valid until its next
     * dv_deform() or dv_destroy(). */
    const char* device;
    /** The warnings; "" if there are none. The text belongs to the deformer, and is valid until its
     * next dv_deform(), dv_deform_points() or dv_destroy(). */
    const char* warnings;
  } dv_report;

  /** Deforms the volume into the memory of the request. report may be null. */
  DV_EXPORT int32_t dv_deform(dv_deformer* deformer, const dv_request* request, dv_report* report);

  /** The input of dv_deform_points(), and the memory that it writes. */
  typedef struct dv_points_request
  {
    /** The size of the structure in bytes, set by the program. */
    size_t struct_size;
    /** The number of points, 0 or more. */
    int64_t number_of_points;
    /** Three numbers per point, in world coordinates. */
    const double* points;
    /** 0: points at rest move to their deformed positions. Not 0: points of the deformed volume
     * move back to rest. */
    int32_t inverse;
    /** Not 0: the points were rounded to floats before. Points outside a mesh by no more than that
     * rounding count as inside. */
    int32_t were_floats;
    /** Memory for three numbers per point: the new positions. May be the memory of points. */
    double* moved;
    /** Memory for one byte per point: 1, or 0 for points that lie outside the deformation and do
     * not move. See dv_set_outside(). */
    int8_t* valid;
    /** The progress callback; null: none. */
    dv_progress progress;
    /** The argument `user` of the callback. */
    void* user;
  } dv_points_request;

  /** The results of dv_deform_points() besides the points. */
  typedef struct dv_points_report
  {
    /** The size of the structure in bytes, set by the program. */
    size_t struct_size;
    /** The number of points that lie outside the deformation. */
    int64_t number_of_outside_points;
    /** The warnings; "" if there are none. The text belongs to the deformer, and is valid until its
     * next dv_deform_points(), dv_deform() or dv_destroy(). */
    const char* warnings;
  } dv_points_report;

  /** Moves points, such as landmarks or a surface, as dv_deform() moves the volume, or back to
   * rest. It needs neither a volume nor a device, and computes in double precision as
   * vtkDeformGeometryFilter does, which documents the map. Where the deformation folds, several
   * points at rest may belong to one deformed point; one of them is chosen. report may be null.
   * Fails if a point is not finite, or if the deformation has no displacements or numbers that are
   * not finite. Unlike dv_deform(), it takes displacements of any length, and meshes that hold no
   * voxel. */
  DV_EXPORT int32_t dv_deform_points(
    dv_deformer* deformer, const dv_points_request* request, dv_points_report* report);

  /** Gets the memory that the deformer has allocated on the device, in bytes. */
  DV_EXPORT int32_t dv_device_memory(const dv_deformer* deformer, uint64_t* bytes);

  /** Frees the memory that the deformer has allocated on the device. The next dv_deform() copies
   * the data to the device again. */
  DV_EXPORT int32_t dv_release_memory(dv_deformer* deformer);

  /* ---- Cutting and carving ---- */

  /*
   * An edit switches off tetrahedra of the volume of a deformer, or divides them. It affects the
   * output of the next dv_deform(). Results are bit for bit those of vtkCutVolume and
   * vtkCarveVolume.
   *
   *   dv_cut, dv_carve_surface, dv_carve_sphere, dv_carve_label, dv_carve_function,
   *   dv_undo_edit, dv_redo_edit, dv_reset_edits, dv_get_masks
   *
   * The volume is edited at rest, independently of its deformation: sheets and bodies are given in
   * world coordinates of the volume at rest. Cuts then move with the tissue. vtkCutVolume and
   * vtkCarveVolume can also edit the deformed volume.
   *
   * Edits accumulate, and their order does not matter. They are combined with the masks of
   * dv_set_active_tetrahedra(), dv_set_boundary_distances() and dv_set_smooth_cut(). Edits do not
   * change these masks, which may be set before or after edits. dv_set_volume() with another grid
   * discards all edits.
   *
   * All input is read during the call only. The volume must be set first. A function that fails or
   * is aborted does not change the edits.
   */

  /** Triangles: a sheet to cut with, or a closed surface to carve with. */
  typedef struct dv_surface
  {
    /** The size of the structure in bytes, set by the program. */
    size_t struct_size;
    /** The number of points. */
    int64_t number_of_points;
    /** Three numbers per point, in world coordinates. */
    const void* points;
    /** The type of points, DV_FLOAT32 or DV_FLOAT64. */
    int32_t point_type;
    /** Must be 0. */
    int32_t reserved;
    /** The number of triangles, 1 or more. */
    int64_t number_of_triangles;
    /** Three point numbers per triangle, in any orientation. */
    const int64_t* triangles;
  } dv_surface;

  /** The rule that decides which tetrahedra are inside a body. */
  enum
  {
    /** Tetrahedra whose centroid is inside. The removed volume approximates that of the body. */
    DV_CARVE_CENTROID = 0,
    /** Tetrahedra with at least one vertex inside. Nothing of the body remains. */
    DV_CARVE_CONSERVATIVE = 1,
    /** Tetrahedra with all vertices inside. Only parts of the body are removed. */
    DV_CARVE_MINIMAL = 2
  };

  /** Options of an edit. A null pointer stands for a structure of zeros. */
  typedef struct dv_edit
  {
    /** The size of the structure in bytes, set by the program. */
    size_t struct_size;
    /** 0: tetrahedra are switched off. Not 0: the edit is smooth. A sheet then divides the
     * tetrahedra that it crosses. A body is carved out with a boundary between the voxels:
     * tetrahedra with all vertices inside are switched off, for any rule, and samples inside the
     * body are discarded in the others. */
    int32_t smooth;
    /** The rule for bodies if smooth is 0: DV_CARVE_CENTROID, DV_CARVE_CONSERVATIVE or
     * DV_CARVE_MINIMAL. */
    int32_t rule;
    /** The progress callback; null: none. */
    dv_progress progress;
    /** The argument `user` of the callback. */
    void* user;
  } dv_edit;

  /** Cuts the tetrahedra that a sheet crosses. The sheet may be open, folded and self-intersecting.
   * Crossings are decided exactly for positions that are rounded to 1/256 voxel. A sheet that
   * misses the volume cuts nothing, which is no error. Fails if there are no triangles, or if a
   * triangle has a point that does not exist, is not finite or is more than 2^31 voxels away. */
  DV_EXPORT int32_t dv_cut(dv_deformer* deformer, const dv_surface* sheet, const dv_edit* edit);

  /** Carves out the region that a closed surface encloses, such as a box of twelve triangles. A
   * point is inside if a ray from it crosses the surface an odd number of times. Points that
   * coincide after rounding to 1/256 voxel are one point. Fails as dv_cut() does, and if the
   * surface is open. */
  DV_EXPORT int32_t dv_carve_surface(
    dv_deformer* deformer, const dv_surface* surface, const dv_edit* edit);

  /** Carves out the region that a sphere sweeps along straight lines from center to center.
   * centers: count points of three numbers, in world coordinates; one point gives a single sphere.
   * Fails if there is no center, if a center is not finite, or if the radius is not finite and
   * greater than 0. */
  DV_EXPORT int32_t dv_carve_sphere(dv_deformer* deformer, int64_t count, const double* centers,
    double radius, const dv_edit* edit);

  /** Carves out the voxels that have a label. labels: an array of one component over the points of
   * the volume. Labels are compared as doubles, which are exact for integers up to 2^53. With
   * DV_CARVE_CENTROID, a tetrahedron is inside if at least three of its four vertices have the
   * label. A smooth boundary lies halfway between voxels. Fails if no voxel has the label. */
  DV_EXPORT int32_t dv_carve_label(
    dv_deformer* deformer, const dv_array* labels, double label, const dv_edit* edit);

  /** Computes values at points. points: three numbers each, in world coordinates. It is called
   * during the library function that it was given to, in threads of the library. It must neither
   * throw nor call functions for the same object. */
  typedef void (*dv_point_function)(
    int64_t count, const double* points, double* values, void* user);

  /** A body that is defined by a function, which is negative inside. */
  typedef struct dv_body
  {
    /** The size of the structure in bytes, set by the program. */
    size_t struct_size;
    /** The function: one value per point. Points with the value NaN are outside. */
    dv_point_function values;
    /** The gradients of the function, three numbers per point, for smooth edits: the distance of a
     * point from the boundary is the value divided by the length of the gradient. Null: the values
     * are distances, in world units. */
    dv_point_function gradients;
    /** The argument `user` of both functions. */
    void* user;
    /** Not 0: both functions may be called from several threads at once. 0: they are called from
     * one thread at a time. */
    int32_t is_thread_safe;
    /** Must be 0. */
    int32_t reserved;
    /** A box that contains the body: x min, x max, y min, y max, z min, z max, in world
     * coordinates. The functions are evaluated only there. All 0: they are evaluated in the whole
     * volume. */
    double bounds[6];
  } dv_body;

  /** Carves out a body. Fails if it has no function, or if its bounds are not finite or not in
   * ascending order. */
  DV_EXPORT int32_t dv_carve_function(
    dv_deformer* deformer, const dv_body* body, const dv_edit* edit);

  /** Undoes the last edit, bit for bit. Fails if there is none. */
  DV_EXPORT int32_t dv_undo_edit(dv_deformer* deformer);
  /** Repeats the edit that was undone last. Fails if there is none, for example after a new edit.
   */
  DV_EXPORT int32_t dv_redo_edit(dv_deformer* deformer);
  /** Discards all edits. */
  DV_EXPORT int32_t dv_reset_edits(dv_deformer* deformer);

  /** The masks of a volume with its edits, in the shapes of dv_set_active_tetrahedra(),
   * dv_set_boundary_distances() and dv_set_smooth_cut(). Null: there is no such mask. A mask that
   * no edit has changed is the memory of the program. Other masks belong to the deformer, and are
   * valid until the next function that edits or sets a mask, dv_set_volume() or dv_destroy(). */
  typedef struct dv_masks
  {
    /** The size of the structure in bytes, set by the program. */
    size_t struct_size;
    /** The active tetrahedra, one byte per cell. */
    const uint8_t* active;
    /** The distances from a smooth boundary, one float per voxel. Those of edits are in world
     * units. */
    const float* boundary_distances;
    /** The tetrahedra that smooth cuts divide, one byte per cell. */
    const uint8_t* crossed;
    /** The distances from the sheets, one float per voxel. Those of edits are in voxels. */
    const float* cut_distances;
    /** The number of tetrahedra that edits have switched off, and that were active before. */
    int64_t number_of_switched_off_tetrahedra;
    /** The number of tetrahedra that edits have divided, and that were not divided before. */
    int64_t number_of_divided_tetrahedra;
    /** The number of edits, without undone ones. */
    int32_t number_of_edits;
    /** The number of undone edits that can be redone. */
    int32_t number_of_undone_edits;
  } dv_masks;

  /** Gets the masks of the volume. */
  DV_EXPORT int32_t dv_get_masks(dv_deformer* deformer, dv_masks* masks);

  /* ---- ChainMail ---- */

  /**
   * The tissue of a volume that handles drag, with stiffness by materials, as in
   * vtkChainMailDeformation and with bit for bit the same results. Each voxel is linked to its six
   * neighbors. A link may be stretched, compressed and sheared within the limits of the materials
   * at its ends. Handles hold voxels and move them. Other voxels follow, each by as little as
   * possible, and relaxation smooths the displacements (Documents/chainmail.md).
   *
   *   dv_chainmail_create, dv_chainmail_set_materials, dv_chainmail_set_pinned,
   *   dv_chainmail_set_active_tetrahedra, dv_chainmail_step, dv_chainmail_reset,
   *   dv_chainmail_displacements, dv_set_chainmail, dv_chainmail_destroy
   *
   * Each step starts from the displacements of the previous one, so that a drag continues. All
   * input is read during the call only. A function that fails or is aborted does not change the
   * displacements. After a failure of the device, only dv_chainmail_destroy() may be called.
   *
   * Memory on the device: 15 bytes per voxel, in blocks of 8 x 8 x 8 voxels, and 12 bytes per
   * voxel for the displacements.
   */
  typedef struct dv_chainmail dv_chainmail;

  /** Creates a ChainMail. Destroy it with dv_chainmail_destroy(). grid: the grid of the volume at
   * rest, with at least two points on each axis. device: as for dv_set_device(). memory_limit: the
   * memory that may be used on the device, in bytes; 0: all that is available. All voxels are at
   * rest, and consist of soft tissue. */
  DV_EXPORT int32_t dv_chainmail_create(
    const dv_grid* grid, const char* device, uint64_t memory_limit, dv_chainmail** chainmail);
  /** Destroys a ChainMail. Null is allowed. Deformers that use its displacements keep them. */
  DV_EXPORT void dv_chainmail_destroy(dv_chainmail* chainmail);

  /** Returns the name of the device. Returns null and sets an error if the ChainMail is null. The
   * text belongs to the ChainMail. */
  DV_EXPORT const char* dv_chainmail_device(const dv_chainmail* chainmail);

  /** The materials of the voxels. */
  typedef struct dv_chainmail_materials
  {
    /** The size of the structure in bytes, set by the program. */
    size_t struct_size;
    /** The limits of the materials, three numbers each, as fractions of the spacing: the shortest
     * length of a link along its axis, 0 to 1; the longest length, 1 to 1000; and the largest
     * displacement of its ends relative to each other across the axis, 0 to 1000. Materials are
     * numbered from 0. A link between two materials has the mean of their limits. Null: 0 is air
     * (0.1, 2, 1), 1 soft tissue (0.5, 1.5, 0.5), 2 muscle (0.8, 1.2, 0.2), 3 cartilage (0.95,
     * 1.05, 0.05), 4 bone (0.99, 1.01, 0.01). */
    const double* table;
    /** The number of materials in the table, 1 to 256. */
    int32_t number_of_materials;
    /** The material of voxels without values, and of voxels whose value is in no range. */
    int32_t default_material;
    /** An array of one component over the volume, which gives the material of each voxel. Without
     * ranges its values are material numbers. Null: all voxels have the default material. */
    const dv_array* values;
    /** Three numbers each: first value, end, material. Voxels with first value <= value < end have
     * this material. If several ranges contain a value, the first of them applies. */
    const double* ranges;
    /** The number of ranges. */
    int64_t number_of_ranges;
  } dv_chainmail_materials;

  /** Sets the materials. If displacements violate the new limits, all displacements are set to 0.
   * Fails if a voxel has no material, or if a limit is out of its range. */
  DV_EXPORT int32_t dv_chainmail_set_materials(
    dv_chainmail* chainmail, const dv_chainmail_materials* materials);

  /** Sets the pinned voxels, which do not move. One byte per voxel: not 0 if the voxel is pinned.
   * Null: no voxel is pinned. */
  DV_EXPORT int32_t dv_chainmail_set_pinned(dv_chainmail* chainmail, const uint8_t* pinned);

  /** Sets the cuts of the tissue, in the shapes of dv_set_active_tetrahedra() and
   * dv_set_smooth_cut(), for example from dv_get_masks(). A link exists if at least one of the up
   * to four tetrahedra with this edge is active and not crossed. Null: all tetrahedra are active,
   * or none is crossed. If displacements violate restored links, all displacements are set to 0. */
  DV_EXPORT int32_t dv_chainmail_set_active_tetrahedra(
    dv_chainmail* chainmail, const uint8_t* active, const uint8_t* crossed);

  /** The input of dv_chainmail_step(). */
  typedef struct dv_chainmail_request
  {
    /** The size of the structure in bytes, set by the program. */
    size_t struct_size;
    /** The number of handles; 0 to relax only. */
    int64_t number_of_handles;
    /** The rest position of each handle, in the volume at rest: three numbers, in world
     * coordinates. */
    const double* rest_positions;
    /** The current position of each handle: three numbers, in world coordinates. The handle
     * displaces its voxels by the difference, at most 4095 voxels on each axis. */
    const double* positions;
    /** The radius around its rest position within which a handle holds voxels, in world units, 0 or
     * more. At least the nearest voxel is held. */
    double handle_radius;
    /** The fraction of the distance to the weighted mean of its neighbors that a voxel moves in a
     * relaxation sweep, 0 to 1. vtkChainMailDeformation uses 1 by default. */
    double elasticity;
    /** Voxels closer to that mean than this fraction of the spacing do not move; decided for each
     * axis independently. 0 or more. */
    double plasticity_threshold;
    /** The number of relaxation sweeps over the blocks that were moved in the last 30 steps, 0 or
     * more. vtkChainMailDeformation uses 5 by default. */
    int32_t relaxation_sweeps;
    /** Must be 0. */
    int32_t reserved;
    /** The progress callback; null: none. Its fraction is always 0, as the duration of a step is
     * not known in advance. */
    dv_progress progress;
    /** The argument `user` of the callback. */
    void* user;
  } dv_chainmail_request;

  /** The results of dv_chainmail_step(). */
  typedef struct dv_chainmail_report
  {
    /** The size of the structure in bytes, set by the program. */
    size_t struct_size;
    /** The number of rounds over moving blocks plus the number of relaxation sweeps. */
    int64_t number_of_sweeps;
    /** The number of voxels whose displacement changed in this step. */
    int64_t number_of_moved_voxels;
    /** The largest violation of a limit by a moved voxel, as a fraction of the spacing. It is 0
     * except after an internal error. */
    double largest_violation;
    /** The number of handles whose displacement was reduced so that pinned voxels and earlier
     * handles do not move. */
    int32_t number_of_reduced_handles;
    /** The number of handles that were released, as no displacement of their voxels was possible,
     * or as they hold no voxel that can move. */
    int32_t number_of_released_handles;
    /** Not 0: all displacements were set to 0 since the last step. */
    int32_t was_reset;
    /** An extent that contains all voxels whose displacement changed since the last step. Empty
     * (first > last) if no displacement changed. */
    int32_t changed_extent[6];
  } dv_chainmail_report;

  /** Moves the handles, then relaxes. report may be null. Fails if a handle is outside the volume,
   * is moved too far, or has a coordinate that is not finite. */
  DV_EXPORT int32_t dv_chainmail_step(
    dv_chainmail* chainmail, const dv_chainmail_request* request, dv_chainmail_report* report);

  /** Sets all displacements to 0. */
  DV_EXPORT int32_t dv_chainmail_reset(dv_chainmail* chainmail);

  /** Gets the displacements of all voxels: three floats each, in world units, x varying fastest.
   * The memory belongs to the ChainMail, and its address does not change. On a device with its own
   * memory, this call updates the values; on a CPU each step does. */
  DV_EXPORT int32_t dv_chainmail_displacements(
    dv_chainmail* chainmail, const float** displacements);

  /** Gets the memory that the ChainMail and its displacements have allocated on the device, in
   * bytes. */
  DV_EXPORT int32_t dv_chainmail_device_memory(const dv_chainmail* chainmail, uint64_t* bytes);

  /** Sets the displacements of a ChainMail as the deformation, which replaces the previous mesh or
   * field. The displacements are not copied, and dv_deform() uses those of the latest step without
   * another call. If the deformer has the same device, they are not copied through the host. While
   * dv_deform() or dv_output_grid() runs, no other thread may use the ChainMail. */
  DV_EXPORT int32_t dv_set_chainmail(dv_deformer* deformer, const dv_chainmail* chainmail);

#ifdef __cplusplus
}
#endif

#endif
