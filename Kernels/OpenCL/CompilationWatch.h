// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeCompilationWatch_h
#define DeformVolumeCompilationWatch_h

#include <chrono>
#include <functional>

namespace deformvolume
{

/// Measures the time that this thread spends on the compilation of kernels during the lifetime of
/// the object, and reports the beginning and the end of each compilation. Drivers compile when a
/// program is built; some drivers compile again at the first launch of a kernel.
class CompilationWatch
{
public:
  /// Called with true when a compilation begins and with false when it ends. May be null.
  using Listener = std::function<void(bool)>;

  explicit CompilationWatch(const Listener& listener);
  ~CompilationWatch();
  CompilationWatch(const CompilationWatch&) = delete;
  CompilationWatch& operator=(const CompilationWatch&) = delete;

  double GetSeconds() const { return this->Seconds; }

  /// Returns the seconds of the innermost watch of this thread; 0 if there is none.
  static double GetCurrentSeconds();

  /// Marks a compilation in this thread, which lasts as long as the object.
  class Compilation
  {
  public:
    Compilation();
    ~Compilation();
    Compilation(const Compilation&) = delete;
    Compilation& operator=(const Compilation&) = delete;

    /// Subtracts seconds in which nothing was compiled.
    void Exclude(double seconds) { this->Excluded += seconds; }

  private:
    std::chrono::steady_clock::time_point Begin = std::chrono::steady_clock::now();
    double Excluded = 0.0;
  };

private:
  Listener Listen;
  double Seconds = 0.0;
  CompilationWatch* Outer; // of the same thread
};

} // namespace deformvolume

#endif
