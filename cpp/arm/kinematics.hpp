// Where the arms and the load are: world frame = frame of arm j-1, moved by the offset, turned by
// q_j (spec 2, spec 3).
//
// z of the world points upwards; its origin is the common origin of the frames of arms 1 and 2,
// `shoulder_height` above the ground.
#pragma once

#include <array>

#include "arm/load.hpp"
#include "arm/vector.hpp"

namespace manutec_r3::arm {

// Homogeneous transformations from the frame of arm j to the world, j = 0 (base) to N; angles
// [rad]. With three moving arms the arms of the wrist follow from six angles, the last three zero.
template <int N>
std::array<Eigen::Matrix4d, N + 1> link_poses(const Vector<N>& q);

// Place of the load in the world [m].
Vector<3> load_position(const Vector<6>& q, const Load& load);

// With the joints of the wrist blocked at zero.
Vector<3> load_position(const Vector<3>& q, const Load& load);

extern template std::array<Eigen::Matrix4d, 4> link_poses<3>(const Vector<3>&);
extern template std::array<Eigen::Matrix4d, 7> link_poses<6>(const Vector<6>&);

}  // namespace manutec_r3::arm
