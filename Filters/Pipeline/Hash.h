// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeHash_h
#define DeformVolumeHash_h

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <vector>

namespace deformvolume
{

/// The hash of no data.
constexpr std::uint64_t HashOfNothing = 14695981039346656037U;

/// Adds data to a hash. A variant of the FNV-1a hash that takes eight bytes at a time.
inline void AddToHash(std::uint64_t& hash, const void* data, std::size_t bytes)
{
  const auto* next = static_cast<const char*>(data);
  for (; bytes > 0;)
  {
    std::uint64_t word = 0;
    const std::size_t size = std::min<std::size_t>(bytes, sizeof(word));
    std::memcpy(&word, next, size);
    hash = (hash ^ word) * 1099511628211U;
    hash ^= hash >> 29;
    next += size;
    bytes -= size;
  }
}

template <typename T>
void AddToHash(std::uint64_t& hash, const std::vector<T>& values)
{
  const std::uint64_t size = values.size();
  AddToHash(hash, &size, sizeof(size));
  AddToHash(hash, values.data(), values.size() * sizeof(T));
}

} // namespace deformvolume

#endif
