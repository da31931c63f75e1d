// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformInteractiveTransferPlot_h
#define DeformInteractiveTransferPlot_h

#include "Transfer.h"

#include <vtkNew.h>

class vtkActor2D;
class vtkPolyData;
class vtkRenderer;

/// A plot of a histogram and an opacity function, at the lower right of a window. Viewer changes
/// the function when the mouse drags the plot.
class TransferPlot
{
public:
  TransferPlot();
  ~TransferPlot();
  TransferPlot(const TransferPlot&) = delete;
  void operator=(const TransferPlot&) = delete;

  void AddTo(vtkRenderer* renderer);
  void Draw(vtkRenderer* renderer, const Histogram& histogram, const Transfer& transfer);
  void SetVisible(bool isVisible);

  /// Whether a pixel is in the plot.
  bool Contains(vtkRenderer* renderer, int x, int y) const;
  static constexpr int Width = 220;
  static constexpr int Height = 80;

private:
  static constexpr int Margin = 12;
  static constexpr int Bottom = 70; // above the status text
  vtkNew<vtkPolyData> Lines;
  vtkNew<vtkActor2D> Actor;
};

#endif
