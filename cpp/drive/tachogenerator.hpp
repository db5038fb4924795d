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
  PerAxis<N> k_t = first<N>(K_T);
  PerAxis<N> we = first<N>(w_e);
  PerAxis<N> wp2 = first<N>(w_p).square();
  PerAxis<N> two_D_wp = 2.0 * first<N>(D_p) * first<N>(w_p);

  // States y, u_t, u_t' and their derivatives.
  void derivatives(const PerAxis<N>& rotor_rate, ConstView<N> y, ConstView<N> u_t,
                   ConstView<N> u_t_rate, View<N> dy, View<N> du_t, View<N> du_t_rate) const {
    dy = we * (k_t * rotor_rate - y);
    du_t = u_t_rate;
    du_t_rate = wp2 * (y - u_t) - two_D_wp * u_t_rate;
  }
};

}  // namespace manutec_r3::drive
