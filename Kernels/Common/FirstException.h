// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeFirstException_h
#define DeformVolumeFirstException_h

#include <atomic>
#include <exception>
#include <mutex>

namespace deformvolume
{

/// Passes the first exception of several threads to the thread that waits for them. Without it, an
/// exception that leaves a thread would terminate the process.
class FirstException
{
public:
  /// Calls a function, unless an earlier function has thrown. Several threads may call Run() at the
  /// same time.
  template <typename Function>
  void Run(Function&& function)
  {
    if (this->Thrown)
    {
      return;
    }
    try
    {
      function();
    }
    catch (...)
    {
      const std::lock_guard<std::mutex> lock(this->Mutex);
      if (!this->Thrown)
      {
        this->Exception = std::current_exception();
        this->Thrown = true;
      }
    }
  }

  /// Rethrows the first exception, if there is one. All threads must have ended.
  void Rethrow() const
  {
    if (this->Exception)
    {
      std::rethrow_exception(this->Exception);
    }
  }

private:
  std::atomic<bool> Thrown{ false };
  std::mutex Mutex;
  std::exception_ptr Exception;
};

} // namespace deformvolume

#endif
