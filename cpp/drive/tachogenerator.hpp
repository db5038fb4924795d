// Tachogenerator, input rotor rate rq', output u_t [V] (spec 4; report Figure 3, Table 1):
//
//   U_t(s) / RQ'(s) = K_T / [ (s/w_e + 1) ((s/w_p)^2 + 2 D_p s/w_p + 1) ]
//
// as a lag followed by an oscillator:
//
//   y'  = w_e (K_T rq' - y)
//   u_t'' = w_p^2 (y - u_t) - 2 D_p w_p u_t'
#pragma once

#include "drive/parameters.hpp"
#include "drive/per_axis.hpp"

namespace manutec_r3::drive {

template <int N>
struct Tachogenerator {
  PerAxis<N> k_t, we, wp2, two_D_wp;

  explicit Tachogenerator(const Table1& table)
      : k_t(first<N>(table.K_T)),
        we(first<N>(table.w_e)),
        wp2(first<N>(table.w_p).square()),
        two_D_wp(2.0 * first<N>(table.D_p) * first<N>(table.w_p)) {}

  // States y, u_t, u_t' and their derivatives.
  void derivatives(const PerAxis<N>& rotor_rate, ConstView<N> y, ConstView<N> u_t,
                   ConstView<N> u_t_rate, View<N> dy, View<N> du_t, View<N> du_t_rate) const {
    dy = we * (k_t * rotor_rate - y);
    du_t = u_t_rate;
    du_t_rate = wp2 * (y - u_t) - two_D_wp * u_t_rate;
  }
};

}  // namespace manutec_r3::drive
