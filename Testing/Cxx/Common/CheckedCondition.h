// SPDX-License-Identifier: BSD-3-Clause
// For macros that print the values of a condition that is not true.
#ifndef CheckedCondition_h
#define CheckedCondition_h

#include <iostream>
#include <sstream>
#include <string>
#include <type_traits>
#include <utility>

namespace checkedCondition
{

template <typename T, typename = void>
struct IsStreamable : std::false_type
{
};
template <typename T>
struct IsStreamable<T,
  std::void_t<decltype(std::declval<std::ostream&>() << std::declval<const T&>())>> : std::true_type
{
};

/// Returns a value as a text, or "?" if its type has no output operator.
template <typename T>
std::string ToText(const T& value)
{
  std::ostringstream text;
  if constexpr (std::is_same_v<T, bool>)
  {
    text << (value ? "true" : "false");
  }
  else if constexpr (std::is_arithmetic_v<T>)
  {
    text << +value; // chars as numbers
  }
  else if constexpr (std::is_pointer_v<T> || std::is_null_pointer_v<T>)
  {
    text << static_cast<const void*>(value);
  }
  else if constexpr (IsStreamable<T>::value)
  {
    text << value;
  }
  else
  {
    text << '?';
  }
  return text.str();
}

/// The result of a condition. If the condition is not true, also a text: the values of both sides
/// of a comparison, or the object that is converted to a bool.
class Condition
{
public:
  Condition(bool isTrue)
    : IsTrue(isTrue)
  {
  }
  Condition(bool isTrue, const std::string& text)
    : IsTrue(isTrue)
    , Values(" (" + text + ")")
  {
  }
  template <typename Left, typename Right>
  Condition(bool isTrue, const Left& left, const char* comparison, const Right& right)
    : IsTrue(isTrue)
  {
    if (!isTrue && (IsStreamable<Left>::value || IsStreamable<Right>::value))
    {
      this->Values = " (" + ToText(left) + comparison + ToText(right) + ")";
    }
  }
  explicit operator bool() const { return this->IsTrue; }
  const std::string& GetValues() const { return this->Values; }

private:
  bool IsTrue;
  std::string Values;
};

// One side of a comparison may be an unsigned integer, and the other one an integer literal.
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wsign-compare"

/// The left side of a comparison, or the whole condition.
template <typename Left>
class LeftSide
{
public:
  explicit LeftSide(const Left& value)
    : Value(value)
  {
  }
  explicit operator bool() const { return this->Value ? true : false; }
  operator Condition() const
  {
    const bool isTrue = static_cast<bool>(*this);
    if constexpr (std::is_class_v<Left> && IsStreamable<Left>::value)
    {
      return isTrue ? Condition(true) : Condition(false, ToText(this->Value));
    }
    else
    {
      return { isTrue };
    }
  }
  template <typename Right>
  Condition operator==(const Right& right) const
  {
    return { this->Value == right, this->Value, " == ", right };
  }
  template <typename Right>
  Condition operator!=(const Right& right) const
  {
    return { this->Value != right, this->Value, " != ", right };
  }
  template <typename Right>
  Condition operator<(const Right& right) const
  {
    return { this->Value < right, this->Value, " < ", right };
  }
  template <typename Right>
  Condition operator<=(const Right& right) const
  {
    return { this->Value <= right, this->Value, " <= ", right };
  }
  template <typename Right>
  Condition operator>(const Right& right) const
  {
    return { this->Value > right, this->Value, " > ", right };
  }
  template <typename Right>
  Condition operator>=(const Right& right) const
  {
    return { this->Value >= right, this->Value, " >= ", right };
  }

private:
  const Left& Value;
};

#pragma GCC diagnostic pop

/// The operator << binds tighter than comparisons: Begin() << a < b is (Begin() << a) < b. In a
/// condition with && or || only the result is known.
struct Begin
{
  template <typename Left>
  LeftSide<Left> operator<<(const Left& left) const
  {
    return LeftSide<Left>(left);
  }
};

/// Returns whether the condition is true. If not, prints where it is and its values.
inline bool Check(const char* file, int line, const char* text, const Condition& condition)
{
  if (!condition)
  {
    std::cerr << file << ':' << line << ": not true: " << text << condition.GetValues() << '\n';
  }
  return static_cast<bool>(condition);
}

} // namespace checkedCondition

// Clang warns about << before a comparison.
#ifdef __clang__
#define CHECKED_CONDITION_BEGIN                                                                    \
  _Pragma("clang diagnostic push")                                                                 \
    _Pragma("clang diagnostic ignored \"-Woverloaded-shift-op-parentheses\"")
#define CHECKED_CONDITION_END _Pragma("clang diagnostic pop")
#else
#define CHECKED_CONDITION_BEGIN
#define CHECKED_CONDITION_END
#endif

/// Prints a condition that is not true, with its values, and increments a number of failures.
#define CHECK_CONDITION(condition, failures)                                                       \
  do                                                                                               \
  {                                                                                                \
    CHECKED_CONDITION_BEGIN                                                                        \
    if (!checkedCondition::Check(                                                                  \
          __FILE__, __LINE__, #condition, checkedCondition::Begin() << condition))                 \
    {                                                                                              \
      ++(failures);                                                                                \
    }                                                                                              \
    CHECKED_CONDITION_END                                                                          \
  } while (false)

#endif
