// Articulated bodies with rotors that are carried by the preceding arm (spec 6).
//
// Vectors of six components in the frame of an arm: angular above linear acceleration of the
// origin; torque about the origin above force. Arm j and all arms beyond it, with their joint
// torques given, answer an acceleration a_j of arm j with the wrench
//
//   f_j = IA_j a_j + pA_j,    a_j = X_j a_{j-1} + c_j + S_j qdd_j.
#include "arm/articulated.hpp"

#include "arm/rotation.hpp"

namespace manutec_r3::arm {
namespace {

Vector<6> stacked(const Vector<3>& angular, const Vector<3>& linear) {
  Vector<6> both;
  both << angular, linear;
  return both;
}

Matrix<6> spatial_inertia(const Moments& arm) {
  const Matrix<3> H = cross_matrix(as_vector(arm.h));
  Matrix<6> I;
  I << inertia(arm), H, H.transpose(), arm.m * Matrix<3>::Identity();
  return I;
}

// Takes accelerations of arm j-1 to arm j; its transpose takes wrenches of arm j to arm j-1.
Matrix<6> to_outer_arm(const Matrix<3>& R, const Vector<3>& r) {
  Matrix<6> X;
  X << R.transpose(), Matrix<3>::Zero(), -R.transpose() * cross_matrix(r), R.transpose();
  return X;
}

}  // namespace

template <int N>
Vector<N> articulated_forward_dynamics(const Mechanism<N>& mechanism, const Vector<N>& q,
                                       const Vector<N>& qd, const Vector<N>& tau) {
  std::array<Matrix<6>, N> X, IA;
  std::array<Vector<6>, N> c, pA, U;
  Vector<N> u, D, qdd;

  // Outwards: what the rates do.
  Vector<3> w = Vector<3>::Zero();
  for (int j = 0; j < N; ++j) {
    const Vector<3> an = unit(joint_axes[j]);
    const Vector<3> rn = as_vector(mechanism.rotor_axis(j));
    const Vector<3> r = as_vector(mechanism.offset(j));
    const Matrix<3> R = rotation(joint_axes[j], q[j]);
    const Vector<3> gyroscopic = mechanism.rotor(j).p_rJ * qd[j] * w.cross(rn);
    if (j > 0) pA[j - 1].template head<3>() += gyroscopic;

    const Vector<3> centripetal = R.transpose() * w.cross(w.cross(r));
    w = R.transpose() * w;
    X[j] = to_outer_arm(R, r);
    c[j] = stacked(w.cross(an) * qd[j], centripetal);
    w += an * qd[j];

    const Moments& arm = mechanism.arm(j);
    IA[j] = spatial_inertia(arm);
    pA[j] = stacked(w.cross(inertia(arm) * w), w.cross(w.cross(as_vector(arm.h))));
  }

  // Inwards: what joint j does once arm j-1 is known, qdd_j = (u_j - U_j^T a_{j-1}) / D_j.
  for (int j = N - 1; j >= 0; --j) {
    const RotorTerms& rotor = mechanism.rotor(j);
    const int S = component(joint_axes[j]);
    const Vector<6> p = pA[j] + IA[j] * c[j];
    U[j] = X[j].transpose() * IA[j].col(S);
    U[j].template head<3>() += rotor.p_rJ * as_vector(mechanism.rotor_axis(j));
    D[j] = IA[j](S, S) + rotor.p2_rJ;
    u[j] = tau[j] - p[S];
    if (j == 0) break;
    IA[j - 1] += X[j].transpose() * IA[j] * X[j] - U[j] * U[j].transpose() / D[j];
    pA[j - 1] += X[j].transpose() * p + U[j] * (u[j] / D[j]);
  }

  // Outwards: the accelerations. Gravity acts like a base that is accelerated upwards.
  Vector<6> a = stacked(Vector<3>::Zero(), mechanism.gravity() * unit(Axis::z));
  for (int j = 0; j < N; ++j) {
    qdd[j] = (u[j] - U[j].dot(a)) / D[j];
    a = X[j] * a + c[j];
    a[component(joint_axes[j])] += qdd[j];
  }
  return qdd;
}

template Vector<1> articulated_forward_dynamics(const Mechanism<1>&, const Vector<1>&,
                                                const Vector<1>&, const Vector<1>&);
template Vector<3> articulated_forward_dynamics(const Mechanism<3>&, const Vector<3>&,
                                                const Vector<3>&, const Vector<3>&);
template Vector<6> articulated_forward_dynamics(const Mechanism<6>&, const Vector<6>&,
                                                const Vector<6>&, const Vector<6>&);

}  // namespace manutec_r3::arm
