// SPDX-License-Identifier: BSD-3-Clause
#include "SessionEvents.h"

#include "vtkCellArray.h"
#include "vtkIdList.h"
#include "vtkNew.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <stdexcept>

namespace
{

using deformvolume::SessionEvent;

struct EventForm
{
  const char* Name;
  std::size_t Numbers; // number of arguments; for a cut the minimum
};

// In the order of SessionEvent::KindType.
constexpr std::array<EventForm, SessionEvent::STEP + 1> Forms = { { { "BeginGrab", 4 },
  { "MoveGrab", 4 }, { "EndGrab", 1 }, { "Hold", 1 }, { "Release", 1 }, { "Cut", 13 },
  { "Carve", 5 }, { "Undo", 0 }, { "Redo", 0 }, { "Reset", 0 }, { "Model", 1 },
  { "HandleRadius", 1 }, { "RelaxationSweeps", 1 }, { "NumberOfNodes", 1 }, { "UndoMemory", 1 },
  { "Step", 0 } } };

bool IsCut(const std::vector<double>& numbers)
{
  const double points = numbers[0];
  if (!(points >= 3.0) || points > static_cast<double>(numbers.size()) ||
    points != std::floor(points))
  {
    return false;
  }
  const std::size_t first = 1 + 3 * static_cast<std::size_t>(points);
  if (numbers.size() <= first || (numbers.size() - first) % 3 != 0)
  {
    return false;
  }
  for (std::size_t i = first; i < numbers.size(); ++i)
  {
    if (!(numbers[i] >= 0.0) || numbers[i] >= points || numbers[i] != std::floor(numbers[i]))
    {
      return false;
    }
  }
  return true;
}

bool IsComplete(const SessionEvent& event)
{
  return event.Kind == SessionEvent::CUT
    ? event.Numbers.size() >= Forms[event.Kind].Numbers && IsCut(event.Numbers)
    : event.Numbers.size() == Forms[event.Kind].Numbers;
}

} // namespace

std::string deformvolume::FormatEvent(const SessionEvent& event)
{
  std::string text = Forms[event.Kind].Name;
  for (const double number : event.Numbers)
  {
    // std::to_chars writes a decimal point in all locales.
    constexpr int enough = 17;
    char digits[32];
    const auto end =
      std::to_chars(digits, digits + sizeof(digits), number, std::chars_format::general, enough);
    text += ' ';
    text.append(digits, end.ptr);
  }
  return text;
}

SessionEvent deformvolume::ParseEvent(const std::string& text)
{
  const std::string name = text.substr(0, text.find(' '));
  SessionEvent event;
  std::size_t kind = 0;
  while (kind < Forms.size() && name != Forms[kind].Name)
  {
    ++kind;
  }
  if (kind == Forms.size())
  {
    throw std::runtime_error("there is no event \"" + name + "\"");
  }
  event.Kind = static_cast<SessionEvent::KindType>(kind);
  const char* const textEnd = text.data() + text.size();
  for (const char* at = text.data() + name.size(); at != textEnd;)
  {
    double number = 0.0;
    at = std::find_if(at, textEnd, [](char c) { return c != ' '; });
    const auto [end, error] = std::from_chars(at, textEnd, number);
    if (error != std::errc() || !std::isfinite(number))
    {
      throw std::runtime_error("\"" + name + "\" has an argument that is not a finite number");
    }
    event.Numbers.push_back(number);
    at = end;
  }
  if (!IsComplete(event))
  {
    throw std::runtime_error("\"" + name + "\" has missing, superfluous or invalid arguments");
  }
  return event;
}

SessionEvent deformvolume::MakeCutEvent(vtkPolyData* sheet)
{
  if (!sheet || !sheet->GetPoints() || sheet->GetNumberOfPolys() + sheet->GetNumberOfStrips() == 0)
  {
    throw std::runtime_error("The sheet has no triangles. Use a vtkPolyData of triangles.");
  }
  if (sheet->GetNumberOfStrips() > 0)
  {
    throw std::runtime_error("The sheet has " + std::to_string(sheet->GetNumberOfStrips()) +
      " triangle strips. Use vtkTriangleFilter.");
  }
  SessionEvent event;
  event.Kind = SessionEvent::CUT;
  event.Numbers.push_back(static_cast<double>(sheet->GetNumberOfPoints()));
  for (vtkIdType id = 0; id < sheet->GetNumberOfPoints(); ++id)
  {
    double point[3];
    sheet->GetPoint(id, point);
    for (const double coordinate : point)
    {
      if (!std::isfinite(coordinate))
      {
        throw std::runtime_error(
          "Point " + std::to_string(id) + " of the sheet is not finite. Set finite coordinates.");
      }
      event.Numbers.push_back(coordinate);
    }
  }
  vtkNew<vtkIdList> ids;
  for (vtkIdType cell = 0; cell < sheet->GetNumberOfPolys(); ++cell)
  {
    sheet->GetPolys()->GetCellAtId(cell, ids);
    if (ids->GetNumberOfIds() != 3)
    {
      throw std::runtime_error(
        "Cell " + std::to_string(cell) + " of the sheet is not a triangle. Use vtkTriangleFilter.");
    }
    for (vtkIdType i = 0; i < 3; ++i)
    {
      if (ids->GetId(i) < 0 || ids->GetId(i) >= sheet->GetNumberOfPoints())
      {
        throw std::runtime_error("Cell " + std::to_string(cell) + " of the sheet refers to point " +
          std::to_string(ids->GetId(i)) + ", but the sheet has only " +
          std::to_string(sheet->GetNumberOfPoints()) + " points. Correct the cell.");
      }
      event.Numbers.push_back(static_cast<double>(ids->GetId(i)));
    }
  }
  if (!IsComplete(event))
  {
    throw std::runtime_error("The sheet has only " + std::to_string(sheet->GetNumberOfPoints()) +
      " points. A triangle needs three.");
  }
  return event;
}

vtkSmartPointer<vtkPolyData> deformvolume::MakeSheet(const SessionEvent& cut)
{
  const std::vector<double>& numbers = cut.Numbers;
  const std::size_t count = static_cast<std::size_t>(numbers[0]);
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  for (std::size_t i = 0; i < count; ++i)
  {
    points->InsertNextPoint(&numbers[1 + 3 * i]);
  }
  vtkNew<vtkCellArray> triangles;
  for (std::size_t i = 1 + 3 * count; i < numbers.size(); i += 3)
  {
    const vtkIdType ids[3] = { static_cast<vtkIdType>(numbers[i]),
      static_cast<vtkIdType>(numbers[i + 1]), static_cast<vtkIdType>(numbers[i + 2]) };
    triangles->InsertNextCell(3, ids);
  }
  auto sheet = vtkSmartPointer<vtkPolyData>::New();
  sheet->SetPoints(points);
  sheet->SetPolys(triangles);
  return sheet;
}
