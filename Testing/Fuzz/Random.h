// SPDX-License-Identifier: BSD-3-Clause
// Random choices that depend on the seed only, and not on the standard library.
#ifndef Fuzz_Random_h
#define Fuzz_Random_h

#include <cmath>
#include <cstdint>
#include <initializer_list>
#include <random>
#include <vector>

namespace fuzz
{

class Random
{
public:
  explicit Random(std::uint64_t seed)
    : Engine(seed)
  {
  }

  std::uint64_t Bits() { return this->Engine(); }

  /// Returns an integer from low to high, both included.
  int Int(int low, int high)
  {
    const auto count = static_cast<std::uint64_t>(static_cast<std::int64_t>(high) - low + 1);
    return static_cast<int>(low + static_cast<std::int64_t>(this->Engine() % count));
  }
  double Real(double low, double high)
  {
    return low + (high - low) * (static_cast<double>(this->Engine() >> 11) / 9007199254740992.0);
  }
  bool Chance(double probability) { return this->Real(0.0, 1.0) < probability; }

  template <typename T>
  T Pick(std::initializer_list<T> choices)
  {
    return choices.begin()[this->Engine() % choices.size()];
  }
  template <typename T>
  const T& Pick(const std::vector<T>& choices)
  {
    return choices[this->Engine() % choices.size()];
  }
  template <typename T>
  void Shuffle(std::vector<T>& values)
  {
    for (std::size_t i = values.size(); i > 1; --i)
    {
      std::swap(values[i - 1], values[this->Engine() % i]);
    }
  }

private:
  std::mt19937_64 Engine;
};

} // namespace fuzz

#endif
