// M x = b for a symmetric positive definite M of fixed size, by M = U D U^T (spec 6).
//
// Eigen's decompositions are made for matrices of any size, which costs more than the six
// unknowns themselves.
#pragma once

#include "arm/vector.hpp"

namespace manutec_r3::arm {

// `b` becomes x, and M its factors. Reads and writes the upper triangle of M only, from the last
// axis to the first. No pivots are exchanged or tested: a mass matrix is positive definite.
template <int N>
void solve_in_place(Matrix<N>& M, Vector<N>& b) {
  // Above the diagonal M keeps U D, on the diagonal D.
  Vector<N> inverse_D;
  for (int k = N - 1; k >= 0; --k) {
    inverse_D[k] = 1 / M(k, k);
    for (int i = 0; i < k; ++i) {
      const double U_ik = M(i, k) * inverse_D[k];
      for (int j = 0; j <= i; ++j) M(j, i) -= U_ik * M(j, k);
      b[i] -= U_ik * b[k];
    }
  }
  for (int k = 0; k < N; ++k) {
    for (int i = 0; i < k; ++i) b[k] -= M(i, k) * b[i];
    b[k] *= inverse_D[k];
  }
}

}  // namespace manutec_r3::arm
