// SPDX-License-Identifier: BSD-3-Clause
#include "TetGenProcess.h"

#include "ChildOutput.h"

#include "vtkCellArray.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkTetra.h"
#include "vtkUnstructuredGrid.h"

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>
#include <locale>
#include <sstream>
#include <thread>
#include <vector>

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

extern char** environ;

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

// A child process in a process group of its own, so that its children end with it. posix_spawn
// rather than fork: a process in which an OpenCL runtime has started threads must not be forked.
class Child
{
public:
  Child(const std::vector<std::string>& arguments, const ChildOutput& output)
  {
    std::vector<char*> argv;
    for (const std::string& argument : arguments)
    {
      argv.push_back(const_cast<char*>(argument.c_str()));
    }
    argv.push_back(nullptr);

    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_addopen(&actions, 0, "/dev/null", O_RDONLY, 0);
    output.AddTo(actions);
    posix_spawnattr_t attributes;
    posix_spawnattr_init(&attributes);
    sigset_t signals;
    sigemptyset(&signals);
    posix_spawnattr_setsigmask(&attributes, &signals);
    sigaddset(&signals, SIGINT);
    sigaddset(&signals, SIGTERM);
    sigaddset(&signals, SIGPIPE);
    sigaddset(&signals, SIGABRT);
    posix_spawnattr_setsigdefault(&attributes, &signals);
    posix_spawnattr_setflags(
      &attributes, POSIX_SPAWN_SETPGROUP | POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF);
    const int status =
      posix_spawnp(&this->Process, argv[0], &actions, &attributes, argv.data(), environ);
    posix_spawnattr_destroy(&attributes);
    posix_spawn_file_actions_destroy(&actions);
    if (status != 0)
    {
      throw Error("Cannot run TetGen as \"" + arguments[0] + "\": " + std::strerror(status) +
        ". Install TetGen (on Debian and Ubuntu the package tetgen), or give the path of its "
        "program by SetTetGenExecutable() or the environment variable DEFORMVOLUME_TETGEN.");
    }
  }
  ~Child()
  {
    if (!this->Ended)
    {
      kill(-this->Process, SIGKILL);
      while (waitpid(this->Process, nullptr, 0) < 0 && errno == EINTR)
      {
      }
    }
  }
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;

  bool HasEnded()
  {
    const pid_t result = waitpid(this->Process, &this->Status, WNOHANG);
    // ECHILD: the application ignores SIGCHLD, and the status is lost; the files will tell.
    this->Ended = result == this->Process || (result < 0 && errno == ECHILD);
    return this->Ended;
  }
  bool HasSucceeded() const { return WIFEXITED(this->Status) && WEXITSTATUS(this->Status) == 0; }

private:
  pid_t Process = 0;
  int Status = 0;
  bool Ended = false;
};

struct Outcome
{
  bool Succeeded;
  std::string Text;
  bool Complete; // whether Text is all that was printed
};

Outcome Run(const std::vector<std::string>& arguments, Clock::time_point start, double limit,
  const std::function<bool(double)>& wait)
{
  ChildOutput output;
  Child child(arguments, output);
  while (!child.HasEnded())
  {
    output.Read();
    const double seconds = std::chrono::duration<double>(Clock::now() - start).count();
    if (wait(seconds / limit))
    {
      throw Aborted();
    }
    if (seconds > limit)
    {
      std::ostringstream message;
      message << "TetGen did not finish within the TimeLimit of " << limit
              << " s and was ended. Raise TimeLimit, TargetEdgeLength or RadiusEdgeRatio.";
      throw Error(message.str());
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  output.Read();
  return { child.HasSucceeded(), output.GetText(), output.IsTerminal() };
}

// TetGen's output without the report of its progress.
std::string Complaint(const std::string& text)
{
  std::istringstream lines(text);
  std::string line;
  std::string complaint;
  while (std::getline(lines, line))
  {
    const std::size_t first = line.find_first_not_of(" \t\r");
    if (first == std::string::npos)
    {
      continue;
    }
    line = line.substr(first, line.find_last_not_of(" \t\r") + 1 - first);
    const bool progress = line.find("seconds:") != std::string::npos ||
      line.compare(0, 7, "Opening") == 0 || line.compare(0, 7, "Writing") == 0 ||
      line.compare(0, 16, "terminate called") == 0 ||
      (line.size() > 3 && line.compare(line.size() - 3, 3, "...") == 0);
    if (!progress && complaint.size() < 600)
    {
      complaint += (complaint.empty() ? "" : " ") + line;
    }
  }
  return complaint;
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

std::ifstream OpenResult(const std::filesystem::path& path)
{
  std::ifstream file(path);
  file.imbue(std::locale::classic());
  return file;
}

vtkSmartPointer<vtkUnstructuredGrid> ReadMesh(const std::filesystem::path& folder)
{
  const Error incomplete("TetGen's result cannot be read: its files are missing or cut off. Is the "
                         "disk full, or is the program given as TetGen another one?");
  std::ifstream nodes = OpenResult(folder / "surface.1.node");
  std::string rest;
  vtkIdType count = 0;
  vtkIdType firstIndex = 0;
  if (!(nodes >> count) || !std::getline(nodes, rest) || count < 0)
  {
    throw incomplete;
  }
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  for (vtkIdType i = 0; i < count; ++i)
  {
    vtkIdType index;
    double point[3];
    if (!(nodes >> index >> point[0] >> point[1] >> point[2]) || !std::getline(nodes, rest))
    {
      throw incomplete;
    }
    if (i == 0)
    {
      firstIndex = index;
    }
    points->InsertNextPoint(point);
  }

  std::ifstream elements = OpenResult(folder / "surface.1.ele");
  const vtkIdType numberOfPoints = count;
  if (!(elements >> count) || !std::getline(elements, rest))
  {
    throw incomplete;
  }
  vtkNew<vtkCellArray> cells;
  for (vtkIdType i = 0; i < count; ++i)
  {
    vtkIdType index;
    vtkIdType ids[4];
    if (!(elements >> index >> ids[0] >> ids[1] >> ids[2] >> ids[3]) ||
      !std::getline(elements, rest))
    {
      throw incomplete;
    }
    double corners[4][3];
    for (int k = 0; k < 4; ++k)
    {
      ids[k] -= firstIndex;
      if (ids[k] < 0 || ids[k] >= numberOfPoints)
      {
        throw incomplete;
      }
      points->GetPoint(ids[k], corners[k]);
    }
    if (vtkTetra::ComputeVolume(corners[0], corners[1], corners[2], corners[3]) < 0.0)
    {
      std::swap(ids[2], ids[3]);
    }
    cells->InsertNextCell(4, ids);
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

  // p: fill a surface; Y: put no points on it, which would cascade near small angles; F: write no
  // faces; q: quality; a: the largest volume, in digits without an exponent.
  std::ostringstream switches;
  switches.imbue(std::locale::classic());
  switches << std::fixed << "-pYFq" << parameters.RadiusEdgeRatio << 'a';
  const int magnitude = static_cast<int>(std::floor(std::log10(parameters.MaximumVolume)));
  switches.precision(std::max(0, 9 - magnitude));
  switches << parameters.MaximumVolume;

  const Clock::time_point start = Clock::now();
  const Outcome outcome = Run(
    { parameters.Executable, switches.str(), input.string() }, start, parameters.TimeLimit, wait);
  if (!outcome.Succeeded)
  {
    std::string message = Complaint(outcome.Text);
    if (message.empty())
    {
      message = outcome.Complete ? "(no message)"
                                 : "(no message: without pseudo terminals, its messages are lost)";
    }
    if (!parameters.Diagnose)
    {
      throw SurfaceRejected("TetGen failed. It says: " + message);
    }
    // The other mode of TetGen looks for self-intersections, and names them.
    const Outcome diagnosis = Run(
      { parameters.Executable, "-d", input.string() }, start, parameters.TimeLimit + 10.0, wait);
    // TetGen 1.5 counts them there; 1.6 warns of each where it fails, and of others there.
    const std::size_t found = diagnosis.Text.find("!! Found");
    const bool counted = found != std::string::npos;
    if (counted || message.find("intersect") != std::string::npos)
    {
      throw SurfaceRejected("TetGen cannot fill the surface, because it intersects itself. TetGen "
                            "says: " +
        message + (counted ? " " + Complaint(diagnosis.Text.substr(found)) : "") +
        " Fix the surface, or for a volume change the isovalue, TargetEdgeLength or "
        "SmoothingIterations.");
    }
    throw SurfaceRejected("TetGen failed. It says: " + message +
      " For a volume, another TargetEdgeLength or SmoothingIterations may help.");
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
