// Four numbers side by side that go through the same operations: what is true at four instants
// costs processors little more than what is true at one.
//
// The equations are written once, for any kind of number, and evaluated with doubles or with these.
// What branches is frozen between events, the same for all four.
#pragma once

#include <Eigen/Core>

namespace manutec_r3::numbers {

class Abreast {
 public:
  static constexpr int size = 4;

  // The same four times.
  Abreast(double value = 0.0) : values_(Values::Constant(value)) {}

  double operator[](int k) const { return values_[k]; }
  double& operator[](int k) { return values_[k]; }

  static Abreast load(const double* values) { return Values::Map(values); }
  void store(double* values) const { Values::Map(values) = values_; }

  friend Abreast operator+(const Abreast& a, const Abreast& b) { return a.values_ + b.values_; }
  friend Abreast operator-(const Abreast& a, const Abreast& b) { return a.values_ - b.values_; }
  friend Abreast operator*(const Abreast& a, const Abreast& b) { return a.values_ * b.values_; }
  friend Abreast operator/(const Abreast& a, const Abreast& b) { return a.values_ / b.values_; }
  friend Abreast operator-(const Abreast& a) { return -a.values_; }
  friend Abreast min(const Abreast& a, const Abreast& b) { return a.values_.min(b.values_); }
  friend Abreast max(const Abreast& a, const Abreast& b) { return a.values_.max(b.values_); }
  friend Abreast abs(const Abreast& a) { return a.values_.abs(); }
  // Of the four.
  double smallest() const { return values_.minCoeff(); }
  double largest() const { return values_.maxCoeff(); }
  friend Abreast sin(const Abreast& a) { return a.values_.sin(); }
  friend Abreast cos(const Abreast& a) { return a.values_.cos(); }
  Abreast& operator+=(const Abreast& b) { return *this = *this + b; }
  Abreast& operator-=(const Abreast& b) { return *this = *this - b; }
  Abreast& operator*=(const Abreast& b) { return *this = *this * b; }

 private:
  using Values = Eigen::Array<double, size, 1>;

  template <class Expression>
  Abreast(const Eigen::ArrayBase<Expression>& values) : values_(values) {}

  Values values_;
};

// How many numbers one of a kind holds, and how it is read from and written to memory.
template <class Number>
inline constexpr int n_abreast = 1;
template <>
inline constexpr int n_abreast<Abreast> = Abreast::size;

template <class Number>
Number load(const double* values) {
  if constexpr (n_abreast<Number> == 1) {
    return *values;
  } else {
    return Number::load(values);
  }
}
inline void store(double number, double* values) { *values = number; }
inline void store(const Abreast& number, double* values) { number.store(values); }

}  // namespace manutec_r3::numbers

// What Eigen wants to know about a kind of number: here, that it costs no more than a double.
template <>
struct Eigen::NumTraits<manutec_r3::numbers::Abreast>
    : Eigen::GenericNumTraits<manutec_r3::numbers::Abreast> {
  using Real = manutec_r3::numbers::Abreast;
  using NonInteger = manutec_r3::numbers::Abreast;
  using Nested = manutec_r3::numbers::Abreast;
  using Literal = double;
  enum {
    IsComplex = 0,
    IsInteger = 0,
    IsSigned = 1,
    RequireInitialization = 0,
    ReadCost = 1,
    AddCost = 1,
    MulCost = 1
  };
};

// A double and one of these make one of these.
template <class Operation>
struct Eigen::ScalarBinaryOpTraits<double, manutec_r3::numbers::Abreast, Operation> {
  using ReturnType = manutec_r3::numbers::Abreast;
};
template <class Operation>
struct Eigen::ScalarBinaryOpTraits<manutec_r3::numbers::Abreast, double, Operation> {
  using ReturnType = manutec_r3::numbers::Abreast;
};
