// Outwards from arm to arm, everything in the frame of the arm that is visited.
#include "arm/energy.hpp"

#include "arm/rotation.hpp"

namespace manutec_r3::arm {

template <int N>
ArmEnergies<N> energies(const Mechanism<N>& mechanism, const Vector<N>& q, const Vector<N>& qd) {
  ArmEnergies<N> energies;
  // Of the arm last visited: angular velocity, velocity and height of its origin, and what is up.
  Vector<3> w = Vector<3>::Zero();
  Vector<3> v = Vector<3>::Zero();
  double height = 0.0;
  Vector<3> up = unit(Axis::z);
  for (int j = 0; j < N; ++j) {
    energies.carrier_rate[j] = as_vector(mechanism.rotor_axis(j)).dot(w);

    const Vector<3> r = as_vector(mechanism.offset(j));
    const Matrix<3> back = rotation(joint_axes[j], q[j]).transpose();
    v = back * (v + w.cross(r));
    height += up.dot(r);
    up = back * up;
    w = back * w + unit(joint_axes[j]) * qd[j];

    const Moments& arm = mechanism.arm(j);
    const Vector<3> h = as_vector(arm.h);
    energies.kinetic[j] =
        (arm.m * v.squaredNorm() + w.dot(inertia(arm) * w)) / 2.0 + v.dot(w.cross(h));
    energies.potential[j] = mechanism.gravity() * (arm.m * height + up.dot(h));
  }
  return energies;
}

template ArmEnergies<1> energies(const Mechanism<1>&, const Vector<1>&, const Vector<1>&);
template ArmEnergies<3> energies(const Mechanism<3>&, const Vector<3>&, const Vector<3>&);
template ArmEnergies<6> energies(const Mechanism<6>&, const Vector<6>&, const Vector<6>&);

}  // namespace manutec_r3::arm
