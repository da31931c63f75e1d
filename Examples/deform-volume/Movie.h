// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeMovie_h
#define DeformVolumeMovie_h

#include "Picture.h"

#include <vtkGenericMovieWriter.h>
#include <vtkSmartPointer.h>

#include <string>

class Messages;

/// Whether a name ends in what a movie can be written as.
bool CanWriteMovie(const std::string& path);

/// The file of a frame where frames are files of their own: out.png and 12 make out0012.png.
std::string GetFramePath(const std::string& path, int frame);

/// Pictures of a volume before a deformation and meanwhile, one after the other: files of their own
/// (.png), or a video in Ogg Theora (.ogv), 25 frames a second.
class Movie
{
public:
  Movie(vtkImageData* before, const PictureOptions& options, const std::string& path);
  void Add(vtkImageData* after, Messages& messages);
  /// After the last frame.
  void Finish(Messages& messages);

private:
  Picture Frames;
  std::string Path;
  vtkSmartPointer<vtkGenericMovieWriter> Writer; // null: frames are files of their own
  int Number = 0;
};

#endif
