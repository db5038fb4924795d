// Poses of the arms, from the base outwards (spec 2).
#include "arm/kinematics.hpp"

#include "arm/rotation.hpp"

namespace manutec_r3::arm {

template <int N>
std::array<Eigen::Matrix4d, N + 1> link_poses(const Vector<N>& q) {
  std::array<Eigen::Matrix4d, N + 1> poses;
  poses[0].setIdentity();
  for (int j = 0; j < N; ++j) {
    Eigen::Matrix4d joint = Eigen::Matrix4d::Identity();
    joint.topLeftCorner<3, 3>() = rotation(six_arms[j].axis, q[j]);
    joint.topRightCorner<3, 1>() = offset(j);
    poses[j + 1] = poses[j] * joint;
  }
  return poses;
}

Vector<3> load_position(const Vector<6>& q, const Load& load) {
  const Eigen::Vector4d in_arm_6(load.position[0], load.position[1], load.position[2], 1);
  const Eigen::Vector4d in_world = link_poses<6>(q)[6] * in_arm_6;
  return in_world.head<3>();
}

Vector<3> load_position(const Vector<3>& q, const Load& load) {
  return load_position(Vector<6>(q[0], q[1], q[2], 0, 0, 0), load);
}

template std::array<Eigen::Matrix4d, 4> link_poses<3>(const Vector<3>&);
template std::array<Eigen::Matrix4d, 7> link_poses<6>(const Vector<6>&);

}  // namespace manutec_r3::arm
