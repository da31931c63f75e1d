// SPDX-License-Identifier: BSD-3-Clause
#include "TimingTable.h"

#include <iomanip>

void TimingTable::Add(const std::string& step, double seconds)
{
  this->Rows.push_back({ step, seconds });
}

void TimingTable::Print(std::ostream& stream) const
{
  const auto flags = stream.flags();
  const auto line = [&stream](const std::string& step, double seconds)
  {
    stream << std::left << std::setw(28) << step << std::right << std::fixed << std::setw(10)
           << std::setprecision(3) << seconds << "\n";
  };
  double total = 0.0;
  stream << std::left << std::setw(28) << "step" << std::right << std::setw(10) << "seconds"
         << "\n";
  for (const Row& row : this->Rows)
  {
    line(row.Step, row.Seconds);
    total += row.Seconds;
  }
  line("total", total);
  stream.flags(flags);
}
