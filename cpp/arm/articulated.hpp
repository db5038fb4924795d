// Joint accelerations by articulated bodies, in O(n) as in the report (spec 6):
//
//   M(q) qdd = tau - bias(q, qd)
//
// Brandl, Johanni, Otter: A very efficient algorithm for the simulation of robots and similar
// multibody systems without inversion of the mass matrix, IFAC 1986. Six axes are too few for it
// to pay: composite.hpp is faster, and each checks the other.
#pragma once

#include "arm/mechanism.hpp"
#include "arm/vector.hpp"

namespace manutec_r3::arm {

// Angles, rates [rad, rad/s] and torques [N m] of the joints -> accelerations [rad/s^2].
template <int N>
Vector<N> articulated_forward_dynamics(const Mechanism<N>& mechanism, const Vector<N>& q,
                                       const Vector<N>& qd, const Vector<N>& tau);

extern template Vector<1> articulated_forward_dynamics(const Mechanism<1>&, const Vector<1>&,
                                                       const Vector<1>&, const Vector<1>&);
extern template Vector<3> articulated_forward_dynamics(const Mechanism<3>&, const Vector<3>&,
                                                       const Vector<3>&, const Vector<3>&);
extern template Vector<6> articulated_forward_dynamics(const Mechanism<6>&, const Vector<6>&,
                                                       const Vector<6>&, const Vector<6>&);

}  // namespace manutec_r3::arm
