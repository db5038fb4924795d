// Mass matrix and bias of the equations of motion by composite bodies (spec 6):
//
//   M(q) qdd + bias(q, qd) = tau
//
// The simulator spends most of its time here.
#pragma once

#include "arm/mechanism.hpp"
#include "arm/symmetric.hpp"
#include "arm/vector.hpp"
#include "numbers/abreast.hpp"

namespace manutec_r3::arm {

template <int N, class Number = double>
struct EquationsOfMotion {
  Symmetric<N, Number> M;  // positive definite [kg m^2]
  Vector<N, Number> bias;  // centrifugal, Coriolis, gyroscopic and gravity torques [N m]
};

// Angles and rates of the joints [rad, rad/s]. The angle of joint 1, which is vertical, has no
// effect. The numbers are doubles, or four abreast.
template <int N, class Number = double>
EquationsOfMotion<N, Number> equations_of_motion(const Mechanism<N>& mechanism,
                                                 const VectorView<N, Number>& q,
                                                 const VectorView<N, Number>& qd);

template <int N>
Matrix<N> mass_matrix(const Mechanism<N>& mechanism, const VectorView<N>& q) {
  return equations_of_motion<N, double>(mechanism, q, Vector<N>::Zero()).M.full();
}

// Joint torques that hold the arms at rest [N m].
template <int N>
Vector<N> gravity_torques(const Mechanism<N>& mechanism, const VectorView<N>& q) {
  return equations_of_motion<N, double>(mechanism, q, Vector<N>::Zero()).bias;
}

// Joint accelerations [rad/s^2] under the joint torques tau [N m].
template <int N>
Vector<N> forward_dynamics(const Mechanism<N>& mechanism, const VectorView<N>& q,
                           const VectorView<N>& qd, const VectorView<N>& tau);

extern template EquationsOfMotion<1> equations_of_motion(const Mechanism<1>&, const VectorView<1>&,
                                                         const VectorView<1>&);
extern template EquationsOfMotion<3> equations_of_motion(const Mechanism<3>&, const VectorView<3>&,
                                                         const VectorView<3>&);
extern template EquationsOfMotion<6> equations_of_motion(const Mechanism<6>&, const VectorView<6>&,
                                                         const VectorView<6>&);
extern template EquationsOfMotion<1, numbers::Abreast> equations_of_motion(
    const Mechanism<1>&, const VectorView<1, numbers::Abreast>&,
    const VectorView<1, numbers::Abreast>&);
extern template EquationsOfMotion<3, numbers::Abreast> equations_of_motion(
    const Mechanism<3>&, const VectorView<3, numbers::Abreast>&,
    const VectorView<3, numbers::Abreast>&);
extern template EquationsOfMotion<6, numbers::Abreast> equations_of_motion(
    const Mechanism<6>&, const VectorView<6, numbers::Abreast>&,
    const VectorView<6, numbers::Abreast>&);
extern template Vector<1> forward_dynamics(const Mechanism<1>&, const VectorView<1>&,
                                           const VectorView<1>&, const VectorView<1>&);
extern template Vector<3> forward_dynamics(const Mechanism<3>&, const VectorView<3>&,
                                           const VectorView<3>&, const VectorView<3>&);
extern template Vector<6> forward_dynamics(const Mechanism<6>&, const VectorView<6>&,
                                           const VectorView<6>&, const VectorView<6>&);

}  // namespace manutec_r3::arm
