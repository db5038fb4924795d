// Tests in a few lines. TEST(Claim) { ... } is a test case; a failing CHECK reports file, line,
// expression and values, and the test goes on. CMakeLists.txt finds the names in the sources.
#pragma once

#include <cmath>
#include <exception>
#include <iomanip>
#include <iostream>
#include <limits>
#include <sstream>
#include <string>

namespace manutec_r3::testing {

using Body = void (*)();

struct Registration {
  Registration(const char* name, Body body);
};

// Counts a failure and prints where and why.
void fail(const char* file, int line, const std::string& what);

template <class Value>
std::string show(const Value& value) {
  std::ostringstream shown;
  shown << std::setprecision(std::numeric_limits<double>::max_digits10) << value;
  return shown.str();
}

template <class Left, class Right>
void check_equal(const char* file, int line, const char* expression, const Left& left,
                 const Right& right) {
  if (left == right) return;
  fail(file, line, std::string(expression) + ": " + show(left) + " is not " + show(right));
}

inline void check_near(const char* file, int line, const char* expression, double left,
                       double right, double tolerance) {
  if (std::abs(left - right) <= tolerance) return;  // NaN fails
  fail(file, line,
       std::string(expression) + ": " + show(left) + " and " + show(right) + " differ by " +
           show(left - right) + ", allowed is " + show(tolerance));
}

// Calls something that must throw an Exception; returns its message.
template <class Exception, class Function>
std::string check_throws(const char* file, int line, const char* expression, Function&& call) {
  try {
    call();
  } catch (const Exception& exception) {
    return exception.what();
  } catch (const std::exception& exception) {
    fail(file, line, std::string(expression) + " threw something else: " + exception.what());
    return "";
  }
  fail(file, line, std::string(expression) + " did not throw");
  return "";
}

}  // namespace manutec_r3::testing

#define TEST(name)                                                                 \
  static void name();                                                              \
  static const manutec_r3::testing::Registration name##_registration(#name, name); \
  static void name()

#define CHECK(condition) \
  if (!(condition)) manutec_r3::testing::fail(__FILE__, __LINE__, "not true: " #condition)

#define CHECK_EQUAL(left, right) \
  manutec_r3::testing::check_equal(__FILE__, __LINE__, #left " == " #right, (left), (right))

#define CHECK_NEAR(left, right, tolerance)                                                 \
  manutec_r3::testing::check_near(__FILE__, __LINE__, #left " ~ " #right, (left), (right), \
                                  (tolerance))

#define CHECK_THROWS(expression, Exception)                                     \
  manutec_r3::testing::check_throws<Exception>(__FILE__, __LINE__, #expression, \
                                               [&] { static_cast<void>(expression); })
