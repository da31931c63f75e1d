// SPDX-License-Identifier: BSD-3-Clause
#ifndef TimeAllowance_h
#define TimeAllowance_h

#ifdef __has_feature
#if __has_feature(address_sanitizer)
#define DEFORMVOLUME_TEST_SANITIZED
#endif
#elif defined(__SANITIZE_ADDRESS__)
#define DEFORMVOLUME_TEST_SANITIZED
#endif

/// How many random cases there is time for, of some: fewer with the address sanitizer, which is
/// slow, and does not look for wrong results.
constexpr int GetNumberOfCases(int cases)
{
#ifdef DEFORMVOLUME_TEST_SANITIZED
  return cases / 8;
#else
  return cases;
#endif
}

#endif
