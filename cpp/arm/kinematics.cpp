// Poses of the arms, from the base outwards (spec 2).
#include "arm/kinematics.hpp"

#include "arm/rotation.hpp"

namespace manutec_r3::arm {

template <class Number>
std::array<Matrix<4, Number>, 7> link_poses(const Table3& table, const Vector<6, Number>& q) {
  std::array<Matrix<4, Number>, 7> poses;
  poses[0].setIdentity();
  for (int j = 0; j < n_axes; ++j) {
    Matrix<4, Number> joint = Matrix<4, Number>::Identity();
    joint.template topLeftCorner<3, 3>() = rotation(joint_axes[j], q[j]);
    joint.template topRightCorner<3, 1>() =
        Vector<3>::Map(table.arms[j].offset.data()).template cast<Number>();
    poses[j + 1] = poses[j] * joint;
  }
  return poses;
}

template <int N, class Number>
Vector<N, Number> torques_of_force_on_load(const Table3& table, const Load& load,
                                           const Vector<N, Number>& q,
                                           const Vector<3, Number>& force) {
  // Of space.
  using Vector3 = Vector<3, Number>;

  Vector<6, Number> all = Vector<6, Number>::Zero();
  all.template head<N>() = q;
  const std::array<Matrix<4, Number>, 7> poses = link_poses(table, all);
  const Vector3 at_load = Vector<3>::Map(load.position.data()).template cast<Number>();
  const Vector3 point = (poses[n_axes] * at_load.homogeneous()).template head<3>();
  Vector<N, Number> torque;
  for (int j = 0; j < N; ++j) {
    // The axis of a joint is the same seen from either of its arms.
    const Vector3 an = poses[j + 1].template block<3, 1>(0, component(joint_axes[j]));
    const Vector3 origin = poses[j + 1].template block<3, 1>(0, 3);
    torque[j] = an.dot((point - origin).cross(force));
  }
  return torque;
}

template std::array<Matrix<4>, 7> link_poses(const Table3&, const Vector<6>&);
template Vector<1> torques_of_force_on_load(const Table3&, const Load&, const Vector<1>&,
                                            const Vector<3>&);
template Vector<3> torques_of_force_on_load(const Table3&, const Load&, const Vector<3>&,
                                            const Vector<3>&);
template Vector<6> torques_of_force_on_load(const Table3&, const Load&, const Vector<6>&,
                                            const Vector<3>&);
template Vector<1, numbers::Abreast> torques_of_force_on_load(const Table3&, const Load&,
                                                              const Vector<1, numbers::Abreast>&,
                                                              const Vector<3, numbers::Abreast>&);
template Vector<3, numbers::Abreast> torques_of_force_on_load(const Table3&, const Load&,
                                                              const Vector<3, numbers::Abreast>&,
                                                              const Vector<3, numbers::Abreast>&);
template Vector<6, numbers::Abreast> torques_of_force_on_load(const Table3&, const Load&,
                                                              const Vector<6, numbers::Abreast>&,
                                                              const Vector<3, numbers::Abreast>&);

}  // namespace manutec_r3::arm
