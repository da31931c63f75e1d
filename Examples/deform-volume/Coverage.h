// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeCoverage_h
#define DeformVolumeCoverage_h

#include <vtkSmartPointer.h>

class vtkDataArray;
class vtkImageData;

/// 1 for each voxel of the result that the deformed volume covers, else 0.
const char* GetCoverage(vtkImageData* result);

/// A copy of a point array of the result, in which voxels outside the deformed volume are 0.
vtkSmartPointer<vtkDataArray> CopyCovered(vtkImageData* result, const char* name);

#endif
