// Position controller with rate feedforward, motor side (spec 4; report Figure 3, Table 1):
//
//   rq_d = p aq_d,   rq_d' = p aq_d',   u_c = K_V (rq_d - rq) + K_D rq_d'   [V]
//
// Continuous: at every instant. Sampled: at t_k = k T, held until t_{k+1}.
#pragma once

#include "drive/parameters.hpp"
#include "drive/per_axis.hpp"

namespace manutec_r3::drive {

template <int N>
struct PositionController {
  PerAxis<N> p, k_v, k_d;

  explicit PositionController(const Table1& table)
      : p(first<N>(table.gear_ratio)), k_v(first<N>(table.K_V)), k_d(first<N>(table.K_D)) {}

  // The command u_c [V] to the rate controller.
  template <class Angle, class Rate, class RotorAngle>
  PerAxis<N, typename RotorAngle::Scalar> command(const Angle& aq_d, const Rate& aqd_d,
                                                  const RotorAngle& rq) const {
    return k_v * (p * aq_d - rq) + k_d * (p * aqd_d);
  }
};

}  // namespace manutec_r3::drive
