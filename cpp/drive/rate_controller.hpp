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
// project's reading of it) U stays at its limit as long as its equation drives it further out, and
// w tends to U meanwhile. When U is released nothing jumps: there w' is K_S e again.
//
//   U' = 0,   T_0 w' = U - w   while U = s U_limit and s (w + K_S T_0 e - U) > 0
#pragma once

#include "drive/parameters.hpp"
#include "drive/per_axis.hpp"

namespace manutec_r3::drive {

template <int N>
struct RateController {
  PerAxis<N> k_s, k_s_T0, one_by_Te, one_by_Tb, Ta_by_Tb, one_by_T0;
  // On the present branches: w' = w_by_e e + w_by_U (U - w), U' = U_by_drive (w + K_S T_0 e - U).
  PerAxis<N> w_by_e, w_by_U, U_by_drive;

  explicit RateController(const Table1& table)
      : k_s(first<N>(table.K_S)),
        k_s_T0(first<N>(table.K_S) * first<N>(table.T_0)),
        one_by_Te(first<N>(table.T_e).inverse()),
        one_by_Tb(first<N>(table.T_b).inverse()),
        Ta_by_Tb(first<N>(table.T_a) / first<N>(table.T_b)),
        one_by_T0(first<N>(table.T_0).inverse()) {
    for (int i = 0; i < N; ++i) set_branch(i, 0);
  }

  // Where U is, below, inside or above its limits: -1, 0 or +1.
  void set_branch(int axis, int branch) {
    const bool is_free = branch == 0;
    w_by_e[axis] = is_free ? k_s[axis] : 0.0;
    w_by_U[axis] = is_free ? 0.0 : one_by_T0[axis];
    U_by_drive[axis] = is_free ? one_by_Te[axis] : 0.0;
  }

  // e from the command u_c, the tachogenerator's voltage u_t and the filter's lag f [V].
  template <class Number>
  PerAxis<N, Number> rate_error(const PerAxis<N, Number>& command, ConstView<N, Number> u_t,
                                ConstView<N, Number> f) const {
    return command - (f + Ta_by_Tb * (u_t - f));
  }

  // w + K_S T_0 e - U, which moves U, or would if U were not at its limit [V].
  template <class Number>
  PerAxis<N, Number> drive(const PerAxis<N, Number>& e, ConstView<N, Number> w,
                           ConstView<N, Number> U) const {
    return w + k_s_T0 * e - U;
  }

  // States f, w, U and their derivatives; command u_c and tachogenerator voltage u_t [V].
  void derivatives(const PerAxis<N>& command, ConstView<N> u_t, ConstView<N> f, ConstView<N> w,
                   ConstView<N> U, View<N> df, View<N> dw, View<N> dU) const {
    const PerAxis<N> e = rate_error(command, u_t, f);
    df = one_by_Tb * (u_t - f);
    dw = w_by_e * e + w_by_U * (U - w);
    dU = U_by_drive * drive(e, w, U);
  }
};

}  // namespace manutec_r3::drive
