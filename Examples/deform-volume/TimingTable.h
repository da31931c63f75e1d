// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeTimingTable_h
#define DeformVolumeTimingTable_h

#include <chrono>
#include <ostream>
#include <string>
#include <vector>

/// Measures the time since its construction, in seconds.
class Stopwatch
{
public:
  double GetSeconds() const
  {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - this->Start).count();
  }

private:
  std::chrono::steady_clock::time_point Start = std::chrono::steady_clock::now();
};

/// A table of the durations of steps.
class TimingTable
{
public:
  void Add(const std::string& step, double seconds);
  void Print(std::ostream& stream) const;

private:
  struct Row
  {
    std::string Step;
    double Seconds;
  };
  std::vector<Row> Rows;
};

#endif
