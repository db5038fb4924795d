// A number that remembers how it was computed: what the recursions do with it becomes a formula.
//
// Those who need more of an equation than its values, such as derivatives for an optimisation, let
// it run on recorded numbers and read the tape (arm/newton_euler.hpp). A constant is never written
// down before something that is not constant needs it, sums with 0 and products with 0 and 1 are no
// operations, and what is on the tape already is not written again: the formula is as short as one
// written by hand.
#pragma once

#include <Eigen/Core>
#include <compare>
#include <map>
#include <string_view>
#include <vector>

namespace manutec_r3::numbers {

class Recorded;

class Tape {
 public:
  enum class Operation { input, constant, add, subtract, multiply, negate, sine, cosine };

  // One line. What it takes are the places of earlier lines; those with one operand have none for
  // the second, inputs and constants have none at all.
  struct Line {
    Operation operation;
    int first = 0, second = 0;
    double constant = 0;

    auto operator<=>(const Line&) const = default;
  };

  Recorded input();

  // Inputs come first, in their order.
  const std::vector<Line>& lines() const { return lines_; }
  // Where a number stands, a constant too.
  int place_of(const Recorded& number);

  Recorded record(Operation operation, const Recorded& operand);
  Recorded record(Operation operation, const Recorded& first, const Recorded& second);

 private:
  int write(const Line& line);

  std::vector<Line> lines_;
  std::map<Line, int> places_;
};

std::string_view name_of(Tape::Operation operation);

// A constant, or a place on a tape, which outlives it.
class Recorded {
 public:
  Recorded(double constant = 0) : constant_(constant) {}

  friend Recorded operator+(const Recorded& a, const Recorded& b);
  friend Recorded operator-(const Recorded& a, const Recorded& b);
  friend Recorded operator*(const Recorded& a, const Recorded& b);
  friend Recorded operator-(const Recorded& a);
  friend Recorded sin(const Recorded& a);
  friend Recorded cos(const Recorded& a);
  Recorded& operator+=(const Recorded& b) { return *this = *this + b; }

 private:
  friend class Tape;
  Recorded(Tape* tape, int place) : tape_(tape), place_(place) {}

  bool is_constant() const { return tape_ == nullptr; }
  bool is(double constant) const { return is_constant() && constant_ == constant; }

  Tape* tape_ = nullptr;
  int place_ = 0;
  double constant_ = 0;
};

}  // namespace manutec_r3::numbers

// What Eigen wants to know about a kind of number: here, that nothing may be computed twice.
template <>
struct Eigen::NumTraits<manutec_r3::numbers::Recorded>
    : Eigen::GenericNumTraits<manutec_r3::numbers::Recorded> {
  using Real = manutec_r3::numbers::Recorded;
  using NonInteger = manutec_r3::numbers::Recorded;
  using Nested = manutec_r3::numbers::Recorded;
  using Literal = double;
  enum {
    IsComplex = 0,
    IsInteger = 0,
    IsSigned = 1,
    RequireInitialization = 1,
    ReadCost = 1,
    AddCost = 100,
    MulCost = 100
  };
};

// A double times a vector of recorded numbers is one of these.
template <class Operation>
struct Eigen::ScalarBinaryOpTraits<double, manutec_r3::numbers::Recorded, Operation> {
  using ReturnType = manutec_r3::numbers::Recorded;
};
