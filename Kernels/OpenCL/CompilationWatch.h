// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeCompilationWatch_h
#define DeformVolumeCompilationWatch_h

#include <chrono>
#include <functional>

namespace deformvolume
{

/// Adds up what the compilation of kernels takes in this thread while the object lives, and reports
/// when it begins and ends. Drivers compile where a program is built, and some of them again where
/// a kernel is launched for the first time.
class CompilationWatch
{
public:
  /// Called with true when a compilation begins, with false when it ends. Null: nobody listens.
  using Listener = std::function<void(bool)>;

  explicit CompilationWatch(const Listener& listener);
  ~CompilationWatch();
  CompilationWatch(const CompilationWatch&) = delete;
  CompilationWatch& operator=(const CompilationWatch&) = delete;

  double GetSeconds() const { return this->Seconds; }

  /// Seconds of the watch of this thread; 0 where there is none.
  static double GetCurrentSeconds();

  /// A compilation in this thread, from its construction to its end.
  class Compilation
  {
  public:
    Compilation();
    ~Compilation();
    Compilation(const Compilation&) = delete;
    Compilation& operator=(const Compilation&) = delete;

    /// Seconds in between that were no compilation.
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
