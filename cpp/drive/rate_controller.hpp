// Analog rate controller (spec 4; report Figure 3, Table 1):
//
//   feedback filter   y(s) = (s T_a + 1)/(s T_b + 1) u_t(s)
//   rate error        e    = u_c - y
//   control law       U(s) = K_S (s T_0 + 1) / [ s (s T_e + 1) ] e(s)
//
// with the filter's lag f, the integral w and the output U as states:
//
//   T_b f' = u_t - f,         y = f + T_a/T_b (u_t - f)
//   w' = K_S e,               T_e U' = w + K_S T_0 e - U
#pragma once

#include "drive/parameters.hpp"
#include "drive/per_axis.hpp"

namespace manutec_r3::drive {

template <int N>
struct RateController {
  PerAxis<N> k_s = first<N>(K_S);
  PerAxis<N> k_s_T0 = first<N>(K_S) * first<N>(T_0);
  PerAxis<N> one_by_Te = first<N>(T_e).inverse();
  PerAxis<N> one_by_Tb = first<N>(T_b).inverse();
  PerAxis<N> Ta_by_Tb = first<N>(T_a) / first<N>(T_b);

  // States f, w, U and their derivatives; command u_c and tachogenerator voltage u_t [V].
  void derivatives(const PerAxis<N>& command, ConstView<N> u_t, ConstView<N> f, ConstView<N> w,
                   ConstView<N> U, View<N> df, View<N> dw, View<N> dU) const {
    const PerAxis<N> lag = u_t - f;
    const PerAxis<N> e = command - (f + Ta_by_Tb * lag);
    df = one_by_Tb * lag;
    dw = k_s * e;
    dU = one_by_Te * (w + k_s_T0 * e - U);
  }
};

}  // namespace manutec_r3::drive
