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
//
// The report's controller has no anti-windup. With a limit on U (spec 8 offers one; this is the
// project's reading of it) the motor gets the limited U, and while U is beyond its limit on the
// side s, the integral rests as long as e drives it further:  w' = 0 while s e > 0.
#pragma once

#include "drive/parameters.hpp"
#include "drive/per_axis.hpp"

namespace manutec_r3::drive {

template <int N>
struct RateController {
  PerAxis<N> k_s, k_s_T0, one_by_Te, one_by_Tb, Ta_by_Tb;
  PerAxis<N> integrates = PerAxis<N>::Ones();  // on the present branches: 0 where w rests, else 1

  explicit RateController(const Table1& table)
      : k_s(first<N>(table.K_S)),
        k_s_T0(first<N>(table.K_S) * first<N>(table.T_0)),
        one_by_Te(first<N>(table.T_e).inverse()),
        one_by_Tb(first<N>(table.T_b).inverse()),
        Ta_by_Tb(first<N>(table.T_a) / first<N>(table.T_b)) {}

  // e from the command u_c, the tachogenerator's voltage u_t and the filter's lag f [V].
  PerAxis<N> rate_error(const PerAxis<N>& command, ConstView<N> u_t, ConstView<N> f) const {
    return command - (f + Ta_by_Tb * (u_t - f));
  }

  // States f, w, U and their derivatives; command u_c and tachogenerator voltage u_t [V].
  void derivatives(const PerAxis<N>& command, ConstView<N> u_t, ConstView<N> f, ConstView<N> w,
                   ConstView<N> U, View<N> df, View<N> dw, View<N> dU) const {
    const PerAxis<N> e = rate_error(command, u_t, f);
    df = one_by_Tb * (u_t - f);
    dw = integrates * k_s * e;
    dU = one_by_Te * (w + k_s_T0 * e - U);
  }
};

}  // namespace manutec_r3::drive
