// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeMovie_h
#define DeformVolumeMovie_h

#include "OutputFile.h"
#include "Picture.h"

#include <vtkGenericMovieWriter.h>
#include <vtkSmartPointer.h>

#include <optional>
#include <string>

class Messages;

/// Whether a file name has the extension of a format in which movies can be written.
bool CanWriteMovie(const std::string& path);

/// The file name of a frame in a movie of PNG files: out.png and 12 make out0012.png.
std::string GetFramePath(const std::string& path, int frame);

/// Writes pictures of a volume before and during a deformation: one file for each frame (.png), or
/// a video in Ogg Theora (.ogv) with 25 frames per second.
class Movie
{
public:
  Movie(vtkImageData* before, const PictureOptions& options, const std::string& path);
  void Add(vtkImageData* after, Messages& messages);
  /// Completes the file. Call it after the last frame.
  void Finish(Messages& messages);

private:
  Picture Frames;
  std::string Path;
  std::optional<OutputFile> Video; // empty: one PNG file for each frame
  vtkSmartPointer<vtkGenericMovieWriter> Writer;
  int Number = 0;
};

#endif
