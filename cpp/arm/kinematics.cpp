// Poses of the arms, from the base outwards (spec 2).
#include "arm/kinematics.hpp"

#include "arm/rotation.hpp"

namespace manutec_r3::arm {

std::array<Eigen::Matrix4d, 7> link_poses(const Vector<6>& q) {
  std::array<Eigen::Matrix4d, 7> poses;
  poses[0].setIdentity();
  for (int j = 0; j < 6; ++j) {
    Eigen::Matrix4d joint = Eigen::Matrix4d::Identity();
    joint.topLeftCorner<3, 3>() = rotation(six_arms[j].axis, q[j]);
    joint.topRightCorner<3, 1>() = offset(j);
    poses[j + 1] = poses[j] * joint;
  }
  return poses;
}

}  // namespace manutec_r3::arm
