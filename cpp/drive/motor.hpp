// Current controller and motor (spec 4; report Figure 3, Table 1):
//
//   NL1 (dead zone)     v  = U - a for U > a,  0 for |U| <= a,  U + a for U < -a
//   motor (PT2)         m''/w_i^2 + 2 D_i/w_i m' + m = K_M v
//   NL2 (torque limit)  rF = min(max(m, -b), b)
#pragma once

#include "drive/line.hpp"
#include "drive/parameters.hpp"
#include "drive/per_axis.hpp"

namespace manutec_r3::drive {

template <int N>
struct Motor {
  PerAxis<N> wi2, two_D_wi, k_m;
  // On the present branches:
  Line<N> NL1;  // v from U
  Line<N> NL2;  // rF from m

  explicit Motor(const Table1& table)
      : wi2(first<N>(table.w_i).square()),
        two_D_wi(2.0 * first<N>(table.D_i) * first<N>(table.w_i)),
        k_m(first<N>(table.K_M)) {}

  // States m, m' and their derivatives; voltage U.
  void derivatives(ConstView<N> U, ConstView<N> m, ConstView<N> m_rate, View<N> dm,
                   View<N> dm_rate) const {
    dm = m_rate;
    dm_rate = wi2 * (k_m * NL1(U) - m) - two_D_wi * m_rate;
  }
};

}  // namespace manutec_r3::drive
