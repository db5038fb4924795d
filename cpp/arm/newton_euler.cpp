// Newton and Euler: outwards the motion of each arm, inwards the forces that it takes (spec 6).
#include "arm/newton_euler.hpp"

#include "arm/rotation.hpp"

namespace manutec_r3::arm {

template <int N, class Number>
Vector<N, Number> inverse_dynamics(const Mechanism<N>& mechanism, const Vector<N, Number>& q,
                                   const Vector<N, Number>& qd, const Vector<N, Number>& qdd) {
  // Of space.
  using Vector3 = Vector<3, Number>;
  using Matrix3 = Matrix<3, Number>;

  // In the frame of each arm: its rotation into the preceding arm, and the force and the torque,
  // about the arm's origin, that its motion takes.
  std::array<Matrix3, N> R;
  std::array<Vector3, N> force, torque;
  Vector<N, Number> tau;

  // Of the arm last visited: angular velocity and acceleration, and the acceleration of the origin.
  // Gravity acts like a base that is accelerated upwards.
  Vector3 w = Vector3::Zero();
  Vector3 wd = Vector3::Zero();
  Vector3 a = mechanism.gravity() * unit<Number>(Axis::z);

  for (int j = 0; j < N; ++j) {
    // The rotor, carried by arm j-1, spins at p qd; the arms contain it frozen.
    const RotorTerms& rotor = mechanism.rotor(j);
    const Vector3 rn = as_vector<Number>(mechanism.rotor_axis(j));
    tau[j] = rotor.p2_rJ * qdd[j] + rotor.p_rJ * rn.dot(wd);
    if (j > 0) torque[j - 1] += rotor.p_rJ * (qdd[j] * rn + qd[j] * w.cross(rn));

    const Vector3 an = unit<Number>(joint_axes[j]);
    const Vector3 r = as_vector<Number>(mechanism.offset(j));
    R[j] = rotation(joint_axes[j], q[j]);
    a = R[j].transpose() * (a + wd.cross(r) + w.cross(w.cross(r)));
    w = R[j].transpose() * w;
    wd = R[j].transpose() * wd + w.cross(an) * qd[j] + an * qdd[j];
    w += an * qd[j];

    const Moments& arm = mechanism.arm(j);
    const Vector3 h = as_vector<Number>(arm.h);
    const Matrix3 I = inertia(arm).cast<Number>();
    force[j] = arm.m * a + wd.cross(h) + w.cross(w.cross(h));
    torque[j] = I * wd + w.cross(I * w) + h.cross(a);
  }

  for (int j = N - 1; j >= 0; --j) {
    tau[j] += torque[j][component(joint_axes[j])];
    if (j == 0) break;
    const Vector3 f = R[j] * force[j];
    force[j - 1] += f;
    torque[j - 1] += R[j] * torque[j] + as_vector<Number>(mechanism.offset(j)).cross(f);
  }
  return tau;
}

template Vector<1> inverse_dynamics(const Mechanism<1>&, const Vector<1>&, const Vector<1>&,
                                    const Vector<1>&);
template Vector<3> inverse_dynamics(const Mechanism<3>&, const Vector<3>&, const Vector<3>&,
                                    const Vector<3>&);
template Vector<6> inverse_dynamics(const Mechanism<6>&, const Vector<6>&, const Vector<6>&,
                                    const Vector<6>&);
template Vector<1, numbers::Recorded> inverse_dynamics(const Mechanism<1>&,
                                                       const Vector<1, numbers::Recorded>&,
                                                       const Vector<1, numbers::Recorded>&,
                                                       const Vector<1, numbers::Recorded>&);
template Vector<3, numbers::Recorded> inverse_dynamics(const Mechanism<3>&,
                                                       const Vector<3, numbers::Recorded>&,
                                                       const Vector<3, numbers::Recorded>&,
                                                       const Vector<3, numbers::Recorded>&);
template Vector<6, numbers::Recorded> inverse_dynamics(const Mechanism<6>&,
                                                       const Vector<6, numbers::Recorded>&,
                                                       const Vector<6, numbers::Recorded>&,
                                                       const Vector<6, numbers::Recorded>&);

}  // namespace manutec_r3::arm
