// Poses of the arms, from the base outwards (spec 2).
#include "arm/kinematics.hpp"

#include "arm/rotation.hpp"

namespace manutec_r3::arm {

std::array<Eigen::Matrix4d, 7> link_poses(const Table3& table, const Vector<6>& q) {
  std::array<Eigen::Matrix4d, 7> poses;
  poses[0].setIdentity();
  for (int j = 0; j < n_axes; ++j) {
    Eigen::Matrix4d joint = Eigen::Matrix4d::Identity();
    joint.topLeftCorner<3, 3>() = rotation(joint_axes[j], q[j]);
    joint.topRightCorner<3, 1>() = Vector<3>::Map(table.arms[j].offset.data());
    poses[j + 1] = poses[j] * joint;
  }
  return poses;
}

template <int N>
Vector<N> torques_of_force_on_load(const Table3& table, const Load& load, const Vector<N>& q,
                                   const Vector<3>& force) {
  Vector<6> all = Vector<6>::Zero();
  all.template head<N>() = q;
  const std::array<Eigen::Matrix4d, 7> poses = link_poses(table, all);
  const Vector<3> at_load = Vector<3>::Map(load.position.data());
  const Vector<3> point = (poses[n_axes] * at_load.homogeneous()).template head<3>();
  Vector<N> torque;
  for (int j = 0; j < N; ++j) {
    // The axis of a joint is the same seen from either of its arms.
    const Vector<3> an = poses[j + 1].template block<3, 1>(0, component(joint_axes[j]));
    const Vector<3> origin = poses[j + 1].template block<3, 1>(0, 3);
    torque[j] = an.dot((point - origin).cross(force));
  }
  return torque;
}

template Vector<1> torques_of_force_on_load(const Table3&, const Load&, const Vector<1>&,
                                            const Vector<3>&);
template Vector<3> torques_of_force_on_load(const Table3&, const Load&, const Vector<3>&,
                                            const Vector<3>&);
template Vector<6> torques_of_force_on_load(const Table3&, const Load&, const Vector<6>&,
                                            const Vector<3>&);

}  // namespace manutec_r3::arm
