// SPDX-License-Identifier: BSD-3-Clause
#include "OptionTexts.h"

#include <algorithm>

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
    "six or seven numbers X,Y,Z,DX,DY,DZ[,RADIUS] with commas between them");
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
      "--fix", rest, "box: and six numbers X0,X1,Y0,Y1,Z0,Z1 with commas between them");
  }
  else if (kind == "below" || kind == "label")
  {
    fixation.Which = kind == "below" ? Fixation::Kind::Below : Fixation::Kind::Label;
    fixation.Value = ParseNumbers<double, 1>("--fix", rest, kind + ": and a number")[0];
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
    "sphere: and four numbers X,Y,Z,RADIUS with commas between them");
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
  const std::string shape = "MINIMUM:MAXIMUM=E[,NU[,DENSITY]]";
  if (equals == text.size())
  {
    throw UsageError("--material " + text + ": expected " + shape);
  }
  const auto number = [&](const std::string& part)
  { return ParseNumbers<double, 1>("--material", part, "a number in " + shape)[0]; };
  MaterialOfValues material;
  material.Minimum = number(text.substr(0, colon));
  material.Maximum = number(text.substr(colon + 1, equals - colon - 1));
  if (!(material.Minimum < material.Maximum))
  {
    throw UsageError("--material " + text + ": the minimum must be less than the maximum");
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
  const std::string inverted = ",invert";
  TransformFile file;
  file.IsInverted = text.size() > inverted.size() &&
    text.compare(text.size() - inverted.size(), inverted.size(), inverted) == 0;
  file.Path = text.substr(0, text.size() - (file.IsInverted ? inverted.size() : 0));
  if (file.Path.find(',') != std::string::npos)
  {
    throw UsageError("--transform " + text + ": expected FILE or FILE,invert");
  }
  return file;
}
