// SPDX-License-Identifier: BSD-3-Clause
#ifndef TimeAllowance_h
#define TimeAllowance_h

#ifdef __has_feature
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define DEFORMVOLUME_TEST_SANITIZED
#endif
#elif defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define DEFORMVOLUME_TEST_SANITIZED
#endif

/// How many random cases there is time for, of some: fewer with the address or the thread
/// sanitizer, which are slow, and do not look for wrong results.
constexpr int GetNumberOfCases(int cases)
{
#ifdef DEFORMVOLUME_TEST_SANITIZED
  return cases / 8;
#else
  return cases;
#endif
}

#endif
