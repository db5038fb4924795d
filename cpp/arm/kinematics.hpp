// Where the arms are: the frame of arm j is the frame of arm j-1, moved by the offset of the joint
// and turned by q_j (spec 2, spec 3).
//
// z of the world points upwards; its origin is the common origin of the frames of arms 1 and 2,
// `shoulder_height` above the ground.
#pragma once

#include <array>

#include "arm/vector.hpp"

namespace manutec_r3::arm {

// Homogeneous transformations from the frame of arm j to the world, j = 0 (base) to 6; angles
// [rad], zero for joints that are blocked.
std::array<Eigen::Matrix4d, 7> link_poses(const Vector<6>& q);

}  // namespace manutec_r3::arm
