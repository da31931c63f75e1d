// SPDX-License-Identifier: BSD-3-Clause
#include "Movie.h"

#include "Files.h"

#include "Messages.h"

#ifdef DEFORMVOLUME_HAVE_THEORA
#include <vtkOggTheoraWriter.h>
#endif

#include <iomanip>

namespace
{
bool IsVideo(const std::string& path)
{
  return HasSuffix(path, { ".ogv" });
}

#ifdef DEFORMVOLUME_HAVE_THEORA
vtkSmartPointer<vtkGenericMovieWriter> MakeWriter(const std::string& path)
{
  constexpr int framesPerSecond = 25;
  constexpr int best = 2;
  vtkNew<vtkOggTheoraWriter> writer;
  writer->SetFileName(path.c_str());
  writer->SetRate(framesPerSecond);
  writer->SetQuality(best);
  return writer;
}
#else
vtkSmartPointer<vtkGenericMovieWriter> MakeWriter(const std::string&)
{
  return nullptr;
}
#endif
}

bool CanWriteMovie(const std::string& path)
{
#ifdef DEFORMVOLUME_HAVE_THEORA
  if (IsVideo(path))
  {
    return true;
  }
#endif
  return HasSuffix(path, { ".png" });
}

std::string GetFramePath(const std::string& path, int frame)
{
  const std::size_t suffix = path.size() - std::string(".png").size();
  return MakeText(
    path.substr(0, suffix), std::setw(4), std::setfill('0'), frame, path.substr(suffix));
}

Movie::Movie(vtkImageData* before, const PictureOptions& options, const std::string& path)
  : Frames(before, options)
  , Path(path)
{
  if (IsVideo(path))
  {
    this->Video.emplace(path);
    this->Writer = MakeWriter(this->Video->GetPath());
  }
}

void Movie::Add(vtkImageData* after, Messages& messages)
{
  vtkImageData* frame = this->Frames.Draw(after, Picture::Aim::Fixed, messages);
  ++this->Number;
  if (!this->Video)
  {
    WritePNG(frame, GetFramePath(this->Path, this->Number), messages);
    return;
  }
  this->Writer->SetInputData(frame);
  if (this->Number == 1)
  {
    this->Writer->Start();
  }
  this->Writer->Write();
  messages.Check("cannot write " + this->Path, this->Writer->GetError() == 0);
}

void Movie::Finish(Messages& messages)
{
  if (this->Video && this->Number > 0)
  {
    this->Writer->End();
    this->Video->Finish(messages, this->Writer->GetError() == 0);
  }
}
