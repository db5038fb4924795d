// Joint torques of a given motion by the recursion of Newton and Euler (spec 6):
//
//   tau = M(q) qdd + bias(q, qd)
//
// Written with rotation matrices and tensors of inertia: independent of composite.hpp, which it
// checks.
#pragma once

#include "arm/mechanism.hpp"
#include "arm/vector.hpp"
#include "numbers/recorded.hpp"

namespace manutec_r3::arm {

// Angles, rates and accelerations of the joints [rad, rad/s, rad/s^2] -> torques [N m]. The numbers
// are doubles; of recorded ones the torques are formulas (numbers/recorded.hpp).
template <int N, class Number>
Vector<N, Number> inverse_dynamics(const Mechanism<N>& mechanism, const Vector<N, Number>& q,
                                   const Vector<N, Number>& qd, const Vector<N, Number>& qdd);

extern template Vector<1> inverse_dynamics(const Mechanism<1>&, const Vector<1>&, const Vector<1>&,
                                           const Vector<1>&);
extern template Vector<3> inverse_dynamics(const Mechanism<3>&, const Vector<3>&, const Vector<3>&,
                                           const Vector<3>&);
extern template Vector<6> inverse_dynamics(const Mechanism<6>&, const Vector<6>&, const Vector<6>&,
                                           const Vector<6>&);
extern template Vector<1, numbers::Recorded> inverse_dynamics(const Mechanism<1>&,
                                                              const Vector<1, numbers::Recorded>&,
                                                              const Vector<1, numbers::Recorded>&,
                                                              const Vector<1, numbers::Recorded>&);
extern template Vector<3, numbers::Recorded> inverse_dynamics(const Mechanism<3>&,
                                                              const Vector<3, numbers::Recorded>&,
                                                              const Vector<3, numbers::Recorded>&,
                                                              const Vector<3, numbers::Recorded>&);
extern template Vector<6, numbers::Recorded> inverse_dynamics(const Mechanism<6>&,
                                                              const Vector<6, numbers::Recorded>&,
                                                              const Vector<6, numbers::Recorded>&,
                                                              const Vector<6, numbers::Recorded>&);

}  // namespace manutec_r3::arm
