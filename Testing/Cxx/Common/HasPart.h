// SPDX-License-Identifier: BSD-3-Clause
#ifndef HasPart_h
#define HasPart_h

#include <gtest/gtest.h>

#include <string>

/// Whether a text contains a part. A failure shows both.
inline testing::AssertionResult HasPart(const std::string& text, const std::string& part)
{
  return testing::AssertionResult(text.find(part) != std::string::npos)
    << "the part is \"" << part << "\", and the text is \"" << text << "\"";
}

#endif
