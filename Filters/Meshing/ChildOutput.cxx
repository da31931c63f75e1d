// SPDX-License-Identifier: BSD-3-Clause
#include "ChildOutput.h"

#include "Error.h"

#include <cerrno>
#include <cstdlib>
#include <cstring>

#include <fcntl.h>
#include <unistd.h>

namespace deformvolume
{

ChildOutput::ChildOutput()
{
  if (this->OpenTerminal())
  {
    return;
  }
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0)
  {
    throw Error(std::string("Cannot open a pipe for TetGen's messages: ") + std::strerror(errno) +
      ". Are too many files open?");
  }
  this->Reading = ends[0];
  this->Writing = ends[1];
  fcntl(this->Reading, F_SETFL, O_NONBLOCK);
}

ChildOutput::~ChildOutput()
{
  close(this->Reading);
  if (this->Writing >= 0)
  {
    close(this->Writing);
  }
}

bool ChildOutput::OpenTerminal()
{
  this->Reading = posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC | O_NONBLOCK);
  if (this->Reading < 0)
  {
    return false;
  }
  const bool unlocked = grantpt(this->Reading) == 0 && unlockpt(this->Reading) == 0;
  const char* name = unlocked ? ptsname(this->Reading) : nullptr;
  // /dev/ptmx can be there without /dev/pts.
  if (!name || access(name, R_OK | W_OK) != 0)
  {
    close(this->Reading);
    return false;
  }
  this->Name = name;
  return true;
}

void ChildOutput::AddTo(posix_spawn_file_actions_t& actions) const
{
  if (this->IsTerminal())
  {
    posix_spawn_file_actions_addopen(&actions, 1, this->Name.c_str(), O_WRONLY | O_NOCTTY, 0);
  }
  else
  {
    posix_spawn_file_actions_adddup2(&actions, this->Writing, 1);
  }
  posix_spawn_file_actions_adddup2(&actions, 1, 2);
}

void ChildOutput::Read()
{
  char buffer[4096];
  ssize_t length;
  while ((length = read(this->Reading, buffer, sizeof buffer)) > 0)
  {
    // More than enough for a message, whatever the program prints.
    if (this->Text.size() < (1u << 20))
    {
      this->Text.append(buffer, static_cast<std::size_t>(length));
    }
  }
}

} // namespace deformvolume
