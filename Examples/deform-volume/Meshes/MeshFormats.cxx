// SPDX-License-Identifier: BSD-3-Clause
#include "MeshFormats.h"

#include "Files.h"

#include <vtksys/SystemTools.hxx>

namespace
{
// Returns the file name without its folder.
std::string GetName(const std::string& path)
{
  return vtksys::SystemTools::GetFilenameName(path);
}

// Returns the file name without its folder, and with the extension `suffix`.
std::string GetName(const std::string& path, const std::string& suffix)
{
  return vtksys::SystemTools::GetFilenameWithoutLastExtension(path) + suffix;
}

std::string GetMeshioConversion(const std::string& path, const std::string& suffix)
{
  return "Convert it with meshio (pip install meshio): meshio convert " + GetName(path) + " " +
    GetName(path, suffix);
}
}

std::string GetMeshSuffixes()
{
  return ".vtu, .pvtu, .vtm, .vts, .vtr, .vtk, .pvd"
#ifdef DEFORMVOLUME_HAVE_EXODUS
         ", .e, .exo, .ex2"
#endif
#ifdef DEFORMVOLUME_HAVE_VTKHDF
         ", .vtkhdf"
#endif
    ;
}

std::string GetSheetSuffixes()
{
  return ".vtp, .stl, .ply, .obj, .vtk";
}

std::string GetMeshConversion(const std::string& path)
{
  if (HasSuffix(path, { ".stl", ".ply", ".obj", ".off" }))
  {
    return "It holds a surface; fill it with tetrahedra, for example with Gmsh";
  }
  if (HasSuffix(path, { ".nii", ".nii.gz", ".mha", ".mhd", ".nrrd", ".nhdr" }))
  {
    return "Give displacement fields with --field";
  }
  if (HasSuffix(path, { ".csv", ".tsv", ".txt", ".xlsx" }))
  {
    return "It holds a table. Open it in ParaView (.csv), make a mesh of its points with Table To "
           "Structured Grid if they are those of a grid, otherwise with Table To Points and "
           "Delaunay 3D, and save the data as .vts or .vtu (File > Save Data)";
  }
  if (HasSuffix(path, { ".frd" }))
  {
    return "Convert it with ccx2paraview (pip install ccx2paraview): ccx2paraview " +
      GetName(path) + " vtu";
  }
  if (HasSuffix(path, { ".xplt", ".feb" }))
  {
    return "Open the results of FEBio (.xplt) in FEBio Studio and export them as .vtk";
  }
  if (HasSuffix(path, { ".odb", ".op2", ".rst", ".d3plot", ".case", ".foam", ".pvsm" }))
  {
    return "If ParaView can read it, open it there and save the data as .vtu (File > Save Data)";
  }
  if (HasSuffix(path, { ".inp", ".bdf", ".nas", ".fem" }))
  {
    return "It holds a mesh without results. Convert the file of the results instead. For --rest, "
           "convert this file with meshio (pip install meshio): meshio convert " +
      GetName(path) + " " + GetName(path, ".vtu");
  }
  if (HasSuffix(path, { ".series" }))
  {
    return "It lists the files of a series: give one of them";
  }
  if (HasSuffix(path, { ".e", ".exo", ".ex2", ".vtkhdf" }))
  {
    return "This program was built without VTK's reader of such files. Save the data as .vtu in "
           "ParaView (File > Save Data)";
  }
  return GetMeshioConversion(path, ".vtu") +
    "; or open it in ParaView and save the data as .vtu (File > Save Data)";
}

std::string GetSheetConversion(const std::string& path)
{
  if (HasSuffix(path, { ".vtu", ".pvtu", ".vtm", ".pvd", ".e", ".exo", ".ex2", ".vtkhdf" }))
  {
    return "Extract its surface in ParaView (Filters > Extract Surface) and save it as .vtp";
  }
  return GetMeshioConversion(path, ".ply") +
    "; or open it in ParaView and save the surface as .vtp (File > Save Data)";
}
