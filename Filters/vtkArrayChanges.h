// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkArrayChanges
 * @brief   log of the tuples of an array that have been written
 *
 * A producer that writes a few tuples of a large array can log which ones. vtkDeformVolumeFilter
 * then reads only these. Without a log it compares the whole array with its last values. The result
 * is the same.
 *
 * The filter uses the logs of these arrays:
 * - the vectors and the points of the deformation mesh (ports 1 and 2), or the vectors of a
 *   displacement field,
 * - "ActiveTetrahedra", "BoundaryDistance" and, unless there is a vtkValidPointMask, vtkGhostType
 *   of the points of the volume (port 0).
 *
 * @code{.cpp}
 * vtkNew<vtkArrayChanges> changes;
 * changes->SetArray(displacements);
 * // in each frame
 * displacements->SetTypedTuple(node, moved);
 * changes->AddTuples(node, node);
 * @endcode
 *
 * From SetArray() on, all tuples that are written have to be logged. AddTuples() marks the array as
 * modified. An array that is marked as modified by something else counts as changed in all tuples,
 * so do not call its Modified() yourself. Appended tuples need not be logged, because the number of
 * tuples shows them, unless tuples were removed since the last update. A copy of an array has no
 * log.
 *
 * The log keeps the last changes, about 65,000 ranges. A consumer that last read the array before
 * these changes compares the whole array.
 */
#ifndef vtkArrayChanges_h
#define vtkArrayChanges_h

#include "vtkDeformVolumeModule.h" // for export macro
#include "vtkObject.h"
#include "vtkWeakPointer.h" // for vtkWeakPointer

#include <array>  // for std::array
#include <deque>  // for std::deque
#include <vector> // for std::vector

class vtkAbstractArray;
class vtkIdTypeArray;
class vtkInformationObjectBaseKey;

class VTKDEFORMVOLUME_EXPORT vtkArrayChanges : public vtkObject
{
public:
  ///@{
  /**
   * Standard methods for instantiation, type information and printing.
   */
  static vtkArrayChanges* New();
  vtkTypeMacro(vtkArrayChanges, vtkObject);
  void PrintSelf(ostream& os, vtkIndent indent) override;
  ///@}

  /**
   * The key under which the information of an array holds its log.
   */
  static vtkInformationObjectBaseKey* LOG();

  /**
   * The log of an array; null if it has none.
   */
  static vtkArrayChanges* FindLog(vtkAbstractArray* array);

  ///@{
  /**
   * Set/Get the array of this log. The array holds a reference to the log, and has only one log: a
   * new one replaces the last one. The new log is empty. SetArray() marks the array as modified, so
   * that the next update reads all of it: values may have been written before. Default: null.
   */
  void SetArray(vtkAbstractArray* array);
  vtkAbstractArray* GetArray();
  ///@}

  /**
   * Log that the tuples from first to last, both included, have been written, and mark the array as
   * modified. Does nothing if there is no array, or if last is less than first.
   */
  void AddTuples(vtkIdType first, vtkIdType last);

  /**
   * Get the tuples that have been written since the modification time of the array was `time`: the
   * first and the last tuple of each range, in the order of writing. Returns false, and no ranges,
   * if this is not known. Then any tuple may have been written.
   */
  bool GetTuplesSince(vtkMTimeType time, vtkIdTypeArray* ranges);

#ifndef __VTK_WRAP__
  /// The same, as pairs of the first tuple and the one after the last.
  bool GetTuplesSince(vtkMTimeType time, std::vector<std::array<std::size_t, 2>>& ranges) const;
#endif

protected:
  vtkArrayChanges();
  ~vtkArrayChanges() override;

private:
  vtkArrayChanges(const vtkArrayChanges&) = delete;
  void operator=(const vtkArrayChanges&) = delete;

  struct Entry
  {
    vtkMTimeType Time; // modification time of the array after the change
    vtkIdType First;
    vtkIdType Last;
  };

  vtkWeakPointer<vtkAbstractArray> Array;
  std::deque<Entry> Entries;
  vtkMTimeType Begin = 0; // modification time of the array before the first entry
  vtkMTimeType End = 0;   // modification time of the array after the last entry
};

#endif
