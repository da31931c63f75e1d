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

/// Returns how many of some random cases to run. The address sanitizer and the thread sanitizer are
/// slow, and do not look for wrong results, so they run fewer cases.
constexpr int GetNumberOfCases(int cases)
{
#ifdef DEFORMVOLUME_TEST_SANITIZED
  return cases / 8;
#else
  return cases;
#endif
}

#endif
