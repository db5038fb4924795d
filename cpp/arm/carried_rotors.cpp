// Outwards from arm to arm, everything in the frame of the arm that carries the rotor.
#include "arm/carried_rotors.hpp"

#include "arm/rotation.hpp"

namespace manutec_r3::arm {

template <int N, class Number>
CarriedRotors<N, Number> carried_rotors(const Mechanism<N>& mechanism, const Vector<N, Number>& q,
                                        const Vector<N, Number>& qd) {
  // Of space.
  using Vector3 = Vector<3, Number>;

  CarriedRotors<N, Number> rotors = {Matrix<N, Number>::Zero(), Matrix<N, Number>::Zero(),
                                     Vector<N, Number>::Zero()};
  Vector3 w = Vector3::Zero();
  Vector3 wd = Vector3::Zero();
  Eigen::Matrix<Number, 3, N> an;  // axes of the joints i < j
  for (int j = 0; j < N; ++j) {
    const Vector3 rn = as_vector<Number>(mechanism.rotor_axis(j));
    for (int i = 0; i < j; ++i) {
      rotors.projection(i, j) = an.col(i).dot(rn);
      rotors.swing(i, j) = an.col(i).dot(w.cross(rn));
    }
    rotors.drift[j] = rn.dot(wd);

    // Into arm j, at qdd = 0.
    const Matrix<3, Number> back = rotation(joint_axes[j], q[j]).transpose();
    an.leftCols(j) = back * an.leftCols(j);
    an.col(j) = unit<Number>(joint_axes[j]);
    w = back * w;
    wd = back * wd + w.cross(an.col(j)) * qd[j];
    w += an.col(j) * qd[j];
  }
  return rotors;
}

template CarriedRotors<1> carried_rotors(const Mechanism<1>&, const Vector<1>&, const Vector<1>&);
template CarriedRotors<3> carried_rotors(const Mechanism<3>&, const Vector<3>&, const Vector<3>&);
template CarriedRotors<6> carried_rotors(const Mechanism<6>&, const Vector<6>&, const Vector<6>&);
template CarriedRotors<1, numbers::Abreast> carried_rotors(const Mechanism<1>&,
                                                           const Vector<1, numbers::Abreast>&,
                                                           const Vector<1, numbers::Abreast>&);
template CarriedRotors<3, numbers::Abreast> carried_rotors(const Mechanism<3>&,
                                                           const Vector<3, numbers::Abreast>&,
                                                           const Vector<3, numbers::Abreast>&);
template CarriedRotors<6, numbers::Abreast> carried_rotors(const Mechanism<6>&,
                                                           const Vector<6, numbers::Abreast>&,
                                                           const Vector<6, numbers::Abreast>&);

}  // namespace manutec_r3::arm
