// SPDX-License-Identifier: BSD-3-Clause
#include "OptionTexts.h"

#include <vtkElasticDeformation.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <vector>

namespace
{
/// The presets of vtkElasticDeformation, in lower case.
std::vector<std::string> GetTissueNames()
{
  std::vector<std::string> names;
  for (int preset = vtkElasticDeformation::BRAIN; preset <= vtkElasticDeformation::BONE; ++preset)
  {
    std::string name = vtkElasticDeformation::GetMaterialPresetName(preset);
    std::transform(name.begin(), name.end(), name.begin(),
      [](unsigned char letter) { return static_cast<char>(std::tolower(letter)); });
    names.push_back(name);
  }
  return names;
}
}

std::optional<std::array<double, 3>> FindTissue(const std::string& name)
{
  const std::vector<std::string> names = GetTissueNames();
  const auto found = std::find(names.begin(), names.end(), name);
  std::array<double, 3> values{};
  const auto preset = static_cast<int>(found - names.begin()) + vtkElasticDeformation::BRAIN;
  if (!vtkElasticDeformation::GetMaterialPresetValues(preset, values.data()))
  {
    return std::nullopt;
  }
  return values;
}

std::string GetTissues()
{
  std::string all;
  for (const std::string& name : GetTissueNames())
  {
    all += (all.empty() ? "" : ", ") + name;
  }
  return all;
}

Push ParsePush(const std::string& text)
{
  const auto numbers = ParseNumbers<double, 7>(
    "--push", text, "seven numbers X,Y,Z,DX,DY,DZ,RADIUS with commas between them");
  Push push;
  push.Center = { { numbers[0], numbers[1], numbers[2] } };
  push.Displacement = { { numbers[3], numbers[4], numbers[5] } };
  push.Radius = numbers[6];
  if (!(push.Radius > 0.0))
  {
    throw UsageError("--push " + text + ": the radius must be greater than 0");
  }
  return push;
}

Pull ParsePull(const std::string& text)
{
  const bool hasRadius = std::count(text.begin(), text.end(), ',') == 6;
  const auto numbers = ParseNumbers<double, 7>("--pull", hasRadius ? text : text + ",0",
    "six or seven numbers X,Y,Z,DX,DY,DZ[,RADIUS] with commas between them", text);
  Pull pull;
  pull.Point = { { numbers[0], numbers[1], numbers[2] } };
  pull.Displacement = { { numbers[3], numbers[4], numbers[5] } };
  pull.Radius = numbers[6];
  if (!(pull.Radius >= 0.0))
  {
    throw UsageError("--pull " + text + ": the radius must be at least 0");
  }
  return pull;
}

Fixation ParseFixation(const std::string& text)
{
  Fixation fixation;
  fixation.Text = text;
  const std::size_t colon = std::min(text.find(':'), text.size());
  const std::string kind = text.substr(0, colon);
  const std::string rest = text.substr(std::min(colon + 1, text.size()));
  if (kind == "box")
  {
    fixation.Which = Fixation::Kind::Box;
    fixation.Bounds = ParseNumbers<double, 6>(
      "--fix", rest, "box: and six numbers X0,X1,Y0,Y1,Z0,Z1 with commas between them", text);
  }
  else if (kind == "below" || kind == "label")
  {
    fixation.Which = kind == "below" ? Fixation::Kind::Below : Fixation::Kind::Label;
    fixation.Value = ParseNumbers<double, 1>("--fix", rest, kind + ": and a number", text)[0];
  }
  else
  {
    throw UsageError("--fix " + text + ": expected box:X0,X1,Y0,Y1,Z0,Z1, below:Z or label:N");
  }
  return fixation;
}

Carving ParseCarving(const std::string& text)
{
  const std::string shape = "sphere:";
  if (text.compare(0, shape.size(), shape) != 0)
  {
    throw UsageError("--carve " + text + ": expected sphere:X,Y,Z,RADIUS");
  }
  const auto numbers = ParseNumbers<double, 4>("--carve", text.substr(shape.size()),
    "sphere: and four numbers X,Y,Z,RADIUS with commas between them", text);
  Carving carving;
  carving.Center = { { numbers[0], numbers[1], numbers[2] } };
  carving.Radius = numbers[3];
  if (!(carving.Radius > 0.0))
  {
    throw UsageError("--carve " + text + ": the radius must be greater than 0");
  }
  return carving;
}

MaterialOfValues ParseMaterial(const std::string& text)
{
  const std::size_t colon = std::min(text.find(':'), text.size());
  const std::size_t equals = std::min(text.find('=', colon), text.size());
  const std::string shape = "TISSUE, VOXELS=TISSUE or VOXELS=E[,NU[,DENSITY]], where VOXELS is "
                            "MINIMUM:MAXIMUM or label:N, and TISSUE is one of " +
    GetTissues();
  if (equals == text.size())
  {
    throw UsageError("--material " + text + ": expected " + shape);
  }
  const auto number = [&](const std::string& part)
  {
    const std::string expected =
      part.empty() ? shape : "a number instead of " + part + " in " + shape;
    return ParseNumbers<double, 1>("--material", part, expected, text)[0];
  };
  MaterialOfValues material;
  material.IsOfLabel = text.compare(0, colon, "label") == 0;
  const double last = number(text.substr(colon + 1, equals - colon - 1));
  material.Minimum = material.IsOfLabel ? last : number(text.substr(0, colon));
  material.Maximum = material.IsOfLabel ? std::nextafter(last, HUGE_VAL) : last;
  if (!(material.Minimum < material.Maximum))
  {
    throw UsageError("--material " + text + ": the minimum must be less than the maximum");
  }
  if (const auto tissue = FindTissue(text.substr(equals + 1)))
  {
    material.YoungModulus = (*tissue)[0];
    material.PoissonRatio = (*tissue)[1];
    material.Density = (*tissue)[2];
    return material;
  }
  std::istringstream values(text.substr(equals + 1));
  std::string part;
  std::getline(values, part, ',');
  material.YoungModulus = number(part);
  if (std::getline(values, part, ','))
  {
    material.PoissonRatio = number(part);
  }
  if (std::getline(values, part, ','))
  {
    material.Density = number(part);
  }
  if (!values.eof() || text.back() == ',')
  {
    throw UsageError("--material " + text + ": expected " + shape);
  }
  return material;
}

TransformFile ParseTransform(const std::string& text)
{
#ifndef DEFORMVOLUME_HAVE_ITK
  throw UsageError("--transform: this program was built without ITK, which reads transforms");
#endif
  const std::string inverted = ",invert";
  TransformFile file;
  file.IsInverted = text.size() > inverted.size() &&
    text.compare(text.size() - inverted.size(), inverted.size(), inverted) == 0;
  file.Path = text.substr(0, text.size() - (file.IsInverted ? inverted.size() : 0));
  if (file.Path.find(',') != std::string::npos)
  {
    throw UsageError("--transform " + text + ": expected FILE or FILE,invert" +
      (text[0] == '['
          ? ". In place of [FILE,1] of ANTs write FILE,invert, and in place of [FILE,0] only FILE"
          : ""));
  }
  return file;
}

std::array<int, 3> ParseLattice(const std::string& text)
{
  const auto nodes =
    ParseNumbers<int, 3>("--lattice", text, "three node counts NX,NY,NZ with commas between them");
  if (*std::min_element(nodes.begin(), nodes.end()) < 2)
  {
    throw UsageError("--lattice " + text + ": each axis needs at least 2 nodes");
  }
  return nodes;
}

std::array<double, 3> ParseGravity(const std::string& text)
{
  return ParseNumbers<double, 3>("--gravity", text, "three numbers X,Y,Z with commas between them");
}

std::array<double, 3> ParseSpacing(const std::string& text)
{
  const auto spacing = ParseNumbers<double, 3>("--spacing", text, "three numbers X,Y,Z");
  for (const double distance : spacing)
  {
    if (!(distance > 0.0))
    {
      throw UsageError("--spacing " + text + ": the three numbers must be greater than 0");
    }
  }
  return spacing;
}

std::array<double, 3> ParseView(const std::string& text)
{
  const auto view = ParseNumbers<double, 3>("--view", text, "three numbers X,Y,Z");
  if (view == std::array<double, 3>{})
  {
    throw UsageError("--view 0,0,0 is not a direction");
  }
  return view;
}
