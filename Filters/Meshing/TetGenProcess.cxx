// SPDX-License-Identifier: BSD-3-Clause
#include "TetGenProcess.h"

#include "ElasticBody.h"

#include "vtkCellArray.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkUnstructuredGrid.h"
#include "vtksys/Process.h"

#include <glm/vec3.hpp>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <limits>
#include <locale>
#include <memory>
#include <sstream>
#include <vector>

namespace deformvolume
{
namespace
{

using Clock = std::chrono::steady_clock;

class TemporaryFolder
{
public:
  TemporaryFolder()
  {
    std::error_code error;
    const std::filesystem::path parent = std::filesystem::temp_directory_path(error);
    std::string path = (parent / "deformvolume-XXXXXX").string();
    if (error || !mkdtemp(path.data()))
    {
      throw Error("Cannot create a temporary folder (" + path +
        ") for TetGen. Set the environment variable TMPDIR to a folder that can be written.");
    }
    this->Path = path;
  }
  ~TemporaryFolder()
  {
    std::error_code ignored;
    std::filesystem::remove_all(this->Path, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  std::filesystem::path Path;
};

struct Outcome
{
  std::string Failure; // "" if the program succeeded
  std::string Text;    // what it printed
};

Outcome Run(
  const std::vector<std::string>& arguments, double limit, const std::function<bool(double)>& wait)
{
  // Ends the program if it is still running.
  const std::unique_ptr<vtksysProcess, void (*)(vtksysProcess*)> owner(vtksysProcess_New(),
    [](vtksysProcess* ended)
    {
      vtksysProcess_Kill(ended);
      vtksysProcess_WaitForExit(ended, nullptr);
      vtksysProcess_Delete(ended);
    });
  vtksysProcess* process = owner.get();
  std::vector<const char*> command;
  for (const std::string& argument : arguments)
  {
    command.push_back(argument.c_str());
  }
  command.push_back(nullptr);
  vtksysProcess_SetCommand(process, command.data());
  vtksysProcess_SetOption(process, vtksysProcess_Option_MergeOutput, 1);
  vtksysProcess_SetTimeout(process, limit);
  const Clock::time_point start = Clock::now();
  vtksysProcess_Execute(process);
  Outcome outcome;
  char* data;
  int length;
  int pipe;
  do
  {
    if (wait(std::chrono::duration<double>(Clock::now() - start).count() / limit))
    {
      throw Aborted();
    }
    double patience = 0.02;
    pipe = vtksysProcess_WaitForData(process, &data, &length, &patience);
    // A megabyte is enough for any message.
    if (pipe == vtksysProcess_Pipe_STDOUT && outcome.Text.size() < (1u << 20))
    {
      outcome.Text.append(data, static_cast<std::size_t>(length));
    }
  } while (pipe != vtksysProcess_Pipe_None);
  vtksysProcess_WaitForExit(process, nullptr);
  switch (vtksysProcess_GetState(process))
  {
    case vtksysProcess_State_Exited:
      if (const int value = vtksysProcess_GetExitValue(process))
      {
        outcome.Failure = "exit status " + std::to_string(value);
      }
      return outcome;
    case vtksysProcess_State_Exception:
      outcome.Failure = vtksysProcess_GetExceptionString(process);
      return outcome;
    case vtksysProcess_State_Expired:
    {
      std::ostringstream message;
      message
        << "TetGen did not finish within the time limit of " << limit
        << " s and was ended. Raise the time limit, the edge length or the radius-edge ratio.";
      throw Error(message.str());
    }
    default:
      throw Error("Cannot run TetGen as \"" + arguments[0] +
        "\": " + vtksysProcess_GetErrorString(process) +
        ". Install TetGen (on Debian and Ubuntu the package tetgen), or give the path of its "
        "program, which the environment variable DEFORMVOLUME_TETGEN can hold.");
  }
}

// The line of a text at a position.
std::string LineAt(const std::string& text, std::size_t position)
{
  const std::size_t begin = text.rfind('\n', position) + 1;
  return text.substr(begin, std::min<std::size_t>(600, text.find('\n', position) - begin));
}

// The last line that the program printed; "" if that is the C++ library's message of an abort.
std::string LastLine(const std::string& text)
{
  const std::size_t last = text.find_last_not_of(" \t\r\n");
  const std::string line = last == std::string::npos ? "" : LineAt(text, last);
  return line.find("terminate called") == std::string::npos ? line : "";
}

void WriteSurface(const std::filesystem::path& path, vtkPolyData* surface,
  const std::vector<glm::dvec3>& morePoints)
{
  std::ofstream file(path);
  file.imbue(std::locale::classic());
  file.precision(std::numeric_limits<double>::max_digits10);
  const vtkIdType numberOfPoints = surface->GetNumberOfPoints();
  file << numberOfPoints + static_cast<vtkIdType>(morePoints.size()) << " 3 0 0\n";
  for (vtkIdType i = 0; i < numberOfPoints; ++i)
  {
    double point[3];
    surface->GetPoint(i, point);
    file << i << ' ' << point[0] << ' ' << point[1] << ' ' << point[2] << '\n';
  }
  vtkIdType next = numberOfPoints;
  for (const glm::dvec3& point : morePoints)
  {
    file << next++ << ' ' << point.x << ' ' << point.y << ' ' << point.z << '\n';
  }
  file << surface->GetNumberOfPolys() << " 0\n";
  vtkCellArray* triangles = surface->GetPolys();
  vtkIdType size;
  const vtkIdType* ids;
  for (triangles->InitTraversal(); triangles->GetNextCell(size, ids);)
  {
    file << size;
    for (vtkIdType k = 0; k < size; ++k)
    {
      file << ' ' << ids[k];
    }
    file << '\n';
  }
  file << "0\n0\n"; // neither holes nor regions
  file.close();
  if (!file)
  {
    throw Error("Cannot write the temporary file " + path.string() +
      ". Is the disk full? The environment variable TMPDIR chooses another folder.");
  }
}

// Calls read(stream) for each line after the first one, which begins with the number of lines. The
// index at the beginning of each line is skipped.
template <typename Read>
void ReadLines(const std::filesystem::path& path, Read&& read)
{
  std::ifstream file;
  file.exceptions(std::ios::failbit | std::ios::badbit);
  file.imbue(std::locale::classic());
  file.open(path);
  vtkIdType count;
  std::string rest;
  file >> count;
  std::getline(file, rest);
  for (vtkIdType i = 0; i < count; ++i)
  {
    vtkIdType index;
    file >> index;
    read(file);
    std::getline(file, rest);
  }
}

vtkSmartPointer<vtkUnstructuredGrid> ReadMesh(const std::filesystem::path& folder)
{
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  vtkNew<vtkCellArray> cells;
  try
  {
    ReadLines(folder / "surface.1.node",
      [&](std::istream& line)
      {
        double point[3];
        line >> point[0] >> point[1] >> point[2];
        points->InsertNextPoint(point);
      });
    ReadLines(folder / "surface.1.ele",
      [&](std::istream& line)
      {
        vtkIdType ids[4];
        std::array<glm::dvec3, 4> corners{};
        for (std::size_t i = 0; i < corners.size(); ++i)
        {
          line >> ids[i];
          if (ids[i] < 0 || ids[i] >= points->GetNumberOfPoints())
          {
            line.setstate(std::ios::failbit);
          }
          points->GetPoint(ids[i], &corners[i].x);
        }
        // TetGen makes flat tetrahedra if points of the surface lie in one plane except for
        // rounding.
        if (!IsFlat(corners))
        {
          cells->InsertNextCell(4, ids);
        }
      });
  }
  catch (const std::ios::failure&)
  {
    throw Error("TetGen's result cannot be read: its files are missing or cut off. Is the disk "
                "full, or is the given program not TetGen?");
  }
  auto mesh = vtkSmartPointer<vtkUnstructuredGrid>::New();
  mesh->SetPoints(points);
  mesh->SetCells(VTK_TETRA, cells);
  return mesh;
}

} // namespace

vtkSmartPointer<vtkUnstructuredGrid> RunTetGen(
  vtkPolyData* surface, const TetGenParameters& parameters, const std::function<bool(double)>& wait)
{
  const TemporaryFolder folder;
  const std::filesystem::path input = folder.Path / "surface.smesh";
  WriteSurface(input, surface, parameters.Points);

  // p: fill a surface; Y: put no points on it, because TetGen would add more and more near small
  // angles; F: write no faces; q: quality; a: the largest volume, in digits without an exponent.
  std::ostringstream switches;
  switches.imbue(std::locale::classic());
  switches << "-pYF";
  if (parameters.MaximumVolume > 0.0)
  {
    const int magnitude = static_cast<int>(std::floor(std::log10(parameters.MaximumVolume)));
    switches << std::fixed << 'q' << parameters.RadiusEdgeRatio << 'a';
    switches.precision(std::max(0, 9 - magnitude));
    switches << parameters.MaximumVolume;
  }
  const Outcome outcome =
    Run({ parameters.Executable, switches.str(), input.string() }, parameters.TimeLimit, wait);
  if (!outcome.Failure.empty())
  {
    // On every error TetGen ends with abort(), and loses the text that it has printed into a pipe.
    // With -d it searches for self-intersections, reports them and ends normally.
    const std::string report = parameters.Diagnose
      ? Run({ parameters.Executable, "-d", input.string() }, parameters.TimeLimit, wait).Text
      : "";
    // TetGen 1.5 prints their number, TetGen 1.6 a warning for each of them.
    const std::size_t found =
      std::min(report.find("!! Found"), report.find("segments exactly intersect"));
    if (found != std::string::npos)
    {
      throw SurfaceRejected("TetGen cannot fill the surface, because it intersects itself. TetGen "
                            "says: " +
        LineAt(report, found) +
        " Fix the surface, or for a volume change the isovalue, the edge length or "
        "the smoothing.");
    }
    const std::string said = LastLine(outcome.Text);
    throw SurfaceRejected("TetGen failed (" + outcome.Failure + ")." +
      (said.empty() ? "" : " TetGen says: " + said) +
      " For a volume, another edge length or smoothing may help.");
  }
  auto mesh = ReadMesh(folder.Path);
  if (mesh->GetNumberOfCells() == 0)
  {
    throw SurfaceRejected("TetGen made no tetrahedra: the surface encloses nothing. Check that it "
                          "is closed.");
  }
  return mesh;
}

} // namespace deformvolume
