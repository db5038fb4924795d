// M x = b for a symmetric positive definite M of fixed size, by M = U D U^T (spec 6).
//
// Decompositions made for matrices of any size cost more than the six unknowns themselves. So does
// a loop, which the compiler does for several entries at a time, though columns are too short for
// it: six times the instructions. Here every step is written out when the program is compiled.
#pragma once

#include <utility>

#include "arm/symmetric.hpp"
#include "arm/vector.hpp"

namespace manutec_r3::arm {

// Calls body(i) for i = 0, .., n - 1, without a loop: i is known to the compiler.
template <int n, class Body>
constexpr void for_each_index(const Body& body) {
  [&]<int... i>(std::integer_sequence<int, i...>) {
    (body(std::integral_constant<int, i>{}), ...);
  }(std::make_integer_sequence<int, n>{});
}

// x; from the last axis to the first. No pivots are exchanged or tested: a mass matrix is positive
// definite.
template <int N, class Number>
[[gnu::flatten]] Vector<N, Number> solution(Symmetric<N, Number> M, Vector<N, Number> b) {
  // Above the diagonal M keeps U D, on the diagonal D.
  std::array<Number, N> inverse_D;
  for_each_index<N>([&](auto steps) {
    constexpr int k = N - 1 - steps;
    inverse_D[k] = 1.0 / M(k, k);
    for_each_index<k>([&](auto i) {
      const Number U_ik = M(i, k) * inverse_D[k];
      for_each_index<i + 1>([&](auto j) { M(j, i) -= U_ik * M(j, k); });
      b[i] -= U_ik * b[k];
    });
  });
  for_each_index<N>([&](auto k) {
    for_each_index<k>([&](auto i) { b[k] -= M(i, k) * b[i]; });
    b[k] *= inverse_D[k];
  });
  return b;
}

}  // namespace manutec_r3::arm
