// A symmetric matrix of fixed size that keeps what is on and above its diagonal only, column by
// column: 21 numbers of a mass matrix of six axes instead of 36.
#pragma once

#include <algorithm>
#include <array>

#include "arm/vector.hpp"

namespace manutec_r3::arm {

template <int N, class Number = double>
class Symmetric {
 public:
  // M(i, j) and M(j, i) are the same number.
  Number& operator()(int i, int j) { return entries_[place(i, j)]; }
  const Number& operator()(int i, int j) const { return entries_[place(i, j)]; }

  // M - v v^T / divisor.
  void subtract_square(const Vector<N, Number>& v, double divisor) {
    for (int j = 0; j < N; ++j) {
      for (int i = 0; i <= j; ++i) (*this)(i, j) -= v[i] * v[j] / divisor;
    }
  }

  // Unknown i stands alone with a factor of 1.
  void decouple(int i) {
    for (int j = 0; j < N; ++j) (*this)(i, j) = 0.0;
    (*this)(i, i) = 1.0;
  }

  Matrix<N, Number> full() const {
    Matrix<N, Number> full;
    for (int j = 0; j < N; ++j) {
      for (int i = 0; i < N; ++i) full(i, j) = (*this)(i, j);
    }
    return full;
  }

 private:
  static constexpr int place(int i, int j) {
    const int column = std::max(i, j);
    return column * (column + 1) / 2 + std::min(i, j);
  }

  std::array<Number, N*(N + 1) / 2> entries_;
};

}  // namespace manutec_r3::arm
