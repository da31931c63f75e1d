// SPDX-License-Identifier: BSD-3-Clause
#include "LandmarkFile.h"

#include "Failure.h"
#include "Files.h"
#include "MeshSpace.h"
#include "Messages.h"

#include <vtkDataArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtksys/SystemTools.hxx>

#ifdef DEFORMVOLUME_HAVE_JSON
#include <vtk_jsoncpp.h>
#endif

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <iterator>
#include <limits>
#include <locale>
#include <memory>
#include <sstream>

namespace
{
using Range = std::pair<std::size_t, std::size_t>;

std::string GetText(const std::string& text, const Range& range)
{
  return text.substr(range.first, range.second - range.first);
}

[[noreturn]] void Fail(const std::string& path, const std::string& words)
{
  throw Failure("cannot read " + path + ": " + words);
}

/// NaN if the text is not a number.
double GetNumber(const std::string& text)
{
  std::istringstream stream(text);
  stream.imbue(std::locale::classic());
  double number = 0.0;
  const bool isNumber = stream >> number && (stream >> std::ws).eof();
  return isNumber ? number : std::numeric_limits<double>::quiet_NaN();
}

/// The shortest text that represents the number exactly.
std::string GetShortestText(double number)
{
  char text[32];
  const double withoutSign = number == 0.0 ? 0.0 : number; // no -0
  return std::string(text, std::to_chars(text, text + sizeof(text), withoutSign).ptr);
}

/// The columns of a line, without surrounding blanks. Commas in quotation marks do not separate
/// columns.
std::vector<Range> FindColumns(const std::string& text, std::size_t begin, std::size_t end)
{
  std::vector<Range> columns;
  bool isQuoted = false;
  std::size_t first = begin;
  for (std::size_t i = begin; i <= end; ++i)
  {
    isQuoted = isQuoted != (i < end && text[i] == '"');
    if (i == end || (text[i] == ',' && !isQuoted))
    {
      Range column(first, i);
      const auto isBlank = [&](std::size_t position)
      { return std::string(" \t\r").find(text[position]) != std::string::npos; };
      while (column.first < column.second && isBlank(column.first))
      {
        ++column.first;
      }
      while (column.first < column.second && isBlank(column.second - 1))
      {
        --column.second;
      }
      columns.push_back(column);
      first = i + 1;
    }
  }
  return columns;
}

/// The number of columns of the header line.
std::size_t ReadHeader(
  const std::string& path, const std::string& text, const std::vector<Range>& columns)
{
  std::string names;
  for (std::size_t i = 0; i < std::min<std::size_t>(columns.size(), 3); ++i)
  {
    names += vtksys::SystemTools::LowerCase(GetText(text, columns[i])) + ",";
  }
  names.erase(std::remove(names.begin(), names.end(), '"'), names.end());
  if (names != "x,y,z,")
  {
    Fail(path,
      "its first line is \"" + GetText(text, { columns.front().first, columns.back().second }) +
        "\". It must name the columns, and the first three must be x,y,z");
  }
  return columns.size();
}

void ReadTable(const std::string& path, LandmarkFile& file)
{
  const std::string& text = file.Text;
  const std::string mark = "\xEF\xBB\xBF"; // byte order mark, which spreadsheets write
  std::size_t begin = text.compare(0, mark.size(), mark) == 0 ? mark.size() : 0;
  std::size_t expected = 0;
  for (int line = 1; begin < text.size(); ++line)
  {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    const std::vector<Range> columns = FindColumns(text, begin, end);
    begin = end + 1;
    if (columns.size() == 1 && columns[0].first == columns[0].second)
    {
      continue;
    }
    if (expected == 0)
    {
      expected = ReadHeader(path, text, columns);
      continue;
    }
    const std::string thisLine = "its line " + std::to_string(line);
    if (columns.size() != expected)
    {
      Fail(path,
        thisLine + " has " + std::to_string(columns.size()) +
          " columns, but its first line names " + std::to_string(expected));
    }
    double point[3];
    for (std::size_t axis = 0; axis < 3; ++axis)
    {
      Range column = columns[axis];
      if (column.second - column.first > 1 && text[column.first] == '"' &&
        text[column.second - 1] == '"')
      {
        ++column.first;
        --column.second;
      }
      const std::string number = GetText(text, column);
      point[axis] = GetNumber(number);
      if (!std::isfinite(point[axis]))
      {
        Fail(
          path, thisLine + " has \"" + number + "\" as " + "xyz"[axis] + ", which is not a number");
      }
      file.Numbers.push_back(column);
    }
    file.Points->GetPoints()->InsertNextPoint(point);
  }
  KeepSpace(file.Points, "SPACE=LPS");
}

#ifdef DEFORMVOLUME_HAVE_JSON
std::size_t GetLine(const std::string& text, const Json::Value& value)
{
  return static_cast<std::size_t>(
           std::count(text.begin(), text.begin() + value.getOffsetStart(), '\n')) +
    1;
}

Json::Value ParseJson(const std::string& path, const std::string& text)
{
  Json::CharReaderBuilder builder;
  builder["collectComments"] = false;
  builder["failIfExtra"] = true;
  builder["rejectDupKeys"] = true;
  const std::unique_ptr<Json::CharReader> reader(builder.newCharReader());
  Json::Value root;
  std::string errors;
  bool isParsed = false;
  try
  {
    isParsed = reader->parse(text.data(), text.data() + text.size(), &root, &errors);
  }
  catch (const Json::Exception&)
  {
    errors = "it is nested too deeply";
  }
  if (!isParsed)
  {
    // Only the first error, in one line, without the asterisk before it.
    std::istringstream words(errors.substr(0, errors.find("\n* ")));
    std::string word;
    std::string line;
    while (words >> word)
    {
      line += word == "*" ? "" : (line.empty() ? "" : " ") + word;
    }
    Fail(path, "it is not a JSON file, or it is damaged or cut off (" + line + ")");
  }
  return root;
}

/// "LPS" or "RAS". 3D Slicer also reads the numbers of its enumeration.
std::string GetSpace(const std::string& path, const std::string& text, const Json::Value& markup)
{
  const Json::Value& space = markup["coordinateSystem"];
  const std::string name = space.isString() || space.isInt() ? space.asString() : "";
  if (space.isNull() || name == "LPS" || name == "1")
  {
    return "LPS"; // the default of 3D Slicer
  }
  if (name != "RAS" && name != "0")
  {
    Fail(path,
      "the coordinateSystem in its line " + std::to_string(GetLine(text, space)) + " is \"" + name +
        "\", which is neither LPS nor RAS");
  }
  return "RAS";
}

void CheckUnits(const std::string& path, const std::string& text, const Json::Value& markup)
{
  const Json::Value& units = markup["coordinateUnits"];
  const Json::Value& unit = units.isArray() && !units.empty() ? units[0] : units;
  if (!units.isNull() && !(unit.isString() && unit.asString() == "mm"))
  {
    Fail(path,
      "the coordinateUnits in its line " + std::to_string(GetLine(text, units)) +
        " are not mm. Load it into 3D Slicer, and save it in mm");
  }
}

void ReadControlPoint(const std::string& path, const Json::Value& controlPoint, LandmarkFile& file)
{
  const auto fail = [&](const std::string& words)
  {
    Fail(path,
      "the control point in its line " + std::to_string(GetLine(file.Text, controlPoint)) + words);
  };
  if (!controlPoint.isObject())
  {
    fail(" is not an object");
  }
  const Json::Value& status = controlPoint["positionStatus"];
  if (status.isString() && status.asString() != "defined")
  {
    return; // 3D Slicer writes an empty position
  }
  const Json::Value& position = controlPoint["position"];
  double point[3];
  bool isPoint = position.isArray() && position.size() == 3;
  for (int axis = 0; axis < 3 && isPoint; ++axis)
  {
    isPoint = position[axis].isNumeric() && std::isfinite(position[axis].asDouble());
    point[axis] = isPoint ? position[axis].asDouble() : 0.0;
    file.Numbers.emplace_back(position[axis].getOffsetStart(), position[axis].getOffsetLimit());
  }
  if (!isPoint)
  {
    fail(" has no position of three numbers");
  }
  file.Points->GetPoints()->InsertNextPoint(point);
}

void ReadMarkups(const std::string& path, LandmarkFile& file, Messages& messages)
{
  const Json::Value root = ParseJson(path, file.Text);
  const Json::Value& markups = root.isObject() ? root["markups"] : Json::Value::nullSingleton();
  if (!markups.isArray())
  {
    Fail(path, "it has no list of \"markups\", as files of 3D Slicer have");
  }
  std::string ofFile;
  for (const Json::Value& markup : markups)
  {
    if (!markup.isObject())
    {
      Fail(path,
        "the markup in its line " + std::to_string(GetLine(file.Text, markup)) +
          " is not an object");
    }
    const std::string space = GetSpace(path, file.Text, markup);
    if (!ofFile.empty() && space != ofFile)
    {
      Fail(path, "some of its markups are LPS, others RAS. Save them in separate files");
    }
    ofFile = space;
    CheckUnits(path, file.Text, markup);
    const Json::Value& type = markup["type"];
    if (type.isString() && (type.asString() == "ROI" || type.asString() == "Plane"))
    {
      messages.Warn(path + " holds a markup of the type " + type.asString() +
        ": its control points are deformed, but its size, orientation and center are not.");
    }
    const Json::Value& controlPoints = markup["controlPoints"];
    if (!controlPoints.isNull() && !controlPoints.isArray())
    {
      Fail(path,
        "the controlPoints in its line " + std::to_string(GetLine(file.Text, controlPoints)) +
          " are not a list");
    }
    for (const Json::Value& controlPoint : controlPoints)
    {
      ReadControlPoint(path, controlPoint, file);
    }
  }
  KeepSpace(file.Points, ("SPACE=" + ofFile).c_str());
}
#endif
}

bool IsLandmarkFile(const std::string& path)
{
  return HasSuffix(path, { ".csv", ".mrk.json" });
}

LandmarkFile ReadLandmarks(const std::string& path, [[maybe_unused]] Messages& messages)
{
  CheckReadable(path);
  std::ifstream stream(path, std::ios::binary);
  LandmarkFile file;
  file.Text.assign(std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>());
  file.Points = vtkSmartPointer<vtkPolyData>::New();
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  file.Points->SetPoints(points);
#ifdef DEFORMVOLUME_HAVE_JSON
  if (!HasSuffix(path, { ".csv" }))
  {
    ReadMarkups(path, file, messages);
    return file;
  }
#endif
  ReadTable(path, file);
  return file;
}

bool WriteLandmarks(const LandmarkFile& file, vtkPointSet* moved, const std::string& path)
{
  vtkDataArray* mask = moved->GetPointData()->GetArray("vtkValidPointMask");
  std::string text;
  std::size_t copied = 0;
  for (std::size_t i = 0; i < file.Numbers.size(); ++i)
  {
    const auto point = static_cast<vtkIdType>(i / 3);
    if (!mask || mask->GetComponent(point, 0) != 0.0)
    {
      text.append(file.Text, copied, file.Numbers[i].first - copied);
      text += GetShortestText(moved->GetPoint(point)[i % 3]);
      copied = file.Numbers[i].second;
    }
  }
  text.append(file.Text, copied, std::string::npos);
  std::ofstream stream(path, std::ios::binary);
  stream << text << std::flush;
  return stream.good();
}
