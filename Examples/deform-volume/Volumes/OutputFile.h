// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeOutputFile_h
#define DeformVolumeOutputFile_h

#include <string>

class Messages;

/// A file that replaces an older one when it is complete. It is written in a temporary folder
/// beside the older file, and so are its companions, such as the .raw file of an .mhd file. Before
/// Finish(), errors and the signals SIGINT, SIGTERM and SIGHUP remove the folder, and leave the
/// older file unchanged. Devices and pipes, files in a folder without write permission, and
/// symbolic links to files with companions are written directly.
class OutputFile
{
public:
  /// path: the name of the complete file. Throws a Failure if the disk is full.
  explicit OutputFile(const std::string& path);
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  /// The name under which the file must be written. It ends in the name of the complete file.
  const std::string& GetPath() const { return this->Written; }

  /// Moves the written files to their places. The file comes after its companions. Throws a Failure
  /// if there was an error, or if `succeeded` is false, or if the disk is full, so that the end of
  /// a file may be missing.
  void Finish(Messages& messages, bool succeeded = true);

private:
  std::string Path;    // as the user knows it
  std::string Place;   // Path, or the file to which a symbolic link of this name leads
  std::string Folder;  // the temporary folder, or "" if the file is written directly
  std::string Written; // the file in this folder
};

#endif
