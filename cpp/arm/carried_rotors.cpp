// Outwards from arm to arm, everything in the frame of the arm that carries the rotor.
#include "arm/carried_rotors.hpp"

#include "arm/rotation.hpp"

namespace manutec_r3::arm {

template <int N>
CarriedRotors<N> carried_rotors(const Mechanism<N>& mechanism, const Vector<N>& q,
                                const Vector<N>& qd) {
  CarriedRotors<N> rotors = {Matrix<N>::Zero(), Matrix<N>::Zero(), Vector<N>::Zero()};
  Vector<3> w = Vector<3>::Zero();
  Vector<3> wd = Vector<3>::Zero();
  Eigen::Matrix<double, 3, N> an;  // axes of the joints i < j
  for (int j = 0; j < N; ++j) {
    const Vector<3> rn = as_vector(mechanism.rotor_axis(j));
    for (int i = 0; i < j; ++i) {
      rotors.projection(i, j) = an.col(i).dot(rn);
      rotors.swing(i, j) = an.col(i).dot(w.cross(rn));
    }
    rotors.drift[j] = rn.dot(wd);

    // Into arm j, at qdd = 0.
    const Matrix<3> back = rotation(joint_axes[j], q[j]).transpose();
    an.leftCols(j) = back * an.leftCols(j);
    an.col(j) = unit(joint_axes[j]);
    w = back * w;
    wd = back * wd + w.cross(an.col(j)) * qd[j];
    w += an.col(j) * qd[j];
  }
  return rotors;
}

template CarriedRotors<1> carried_rotors(const Mechanism<1>&, const Vector<1>&, const Vector<1>&);
template CarriedRotors<3> carried_rotors(const Mechanism<3>&, const Vector<3>&, const Vector<3>&);
template CarriedRotors<6> carried_rotors(const Mechanism<6>&, const Vector<6>&, const Vector<6>&);

}  // namespace manutec_r3::arm
