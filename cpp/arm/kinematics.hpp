// Where the arms are: the frame of arm j is the frame of arm j-1, moved by the offset of the joint
// and turned by q_j (spec 2, spec 3).
//
// z of the world points upwards; its origin is the common origin of the frames of arms 1 and 2,
// `shoulder_height` above the ground.
#pragma once

#include <array>

#include "arm/load.hpp"
#include "arm/parameters.hpp"
#include "arm/vector.hpp"
#include "numbers/abreast.hpp"

namespace manutec_r3::arm {

// Homogeneous transformations from the frame of arm j to the world, j = 0 (base) to 6; angles
// [rad], zero for joints that are blocked.
template <class Number = double>
std::array<Matrix<4, Number>, 7> link_poses(const Table3& table, const Vector<6, Number>& q);

// Joint torques [N m] of the first N joints that a force on the load does, J^T force; force in the
// world [N]. The numbers are doubles, or four abreast.
template <int N, class Number>
Vector<N, Number> torques_of_force_on_load(const Table3& table, const Load& load,
                                           const Vector<N, Number>& q,
                                           const Vector<3, Number>& force);

extern template std::array<Matrix<4>, 7> link_poses(const Table3&, const Vector<6>&);
extern template Vector<1> torques_of_force_on_load(const Table3&, const Load&, const Vector<1>&,
                                                   const Vector<3>&);
extern template Vector<3> torques_of_force_on_load(const Table3&, const Load&, const Vector<3>&,
                                                   const Vector<3>&);
extern template Vector<6> torques_of_force_on_load(const Table3&, const Load&, const Vector<6>&,
                                                   const Vector<3>&);
extern template Vector<1, numbers::Abreast> torques_of_force_on_load(
    const Table3&, const Load&, const Vector<1, numbers::Abreast>&,
    const Vector<3, numbers::Abreast>&);
extern template Vector<3, numbers::Abreast> torques_of_force_on_load(
    const Table3&, const Load&, const Vector<3, numbers::Abreast>&,
    const Vector<3, numbers::Abreast>&);
extern template Vector<6, numbers::Abreast> torques_of_force_on_load(
    const Table3&, const Load&, const Vector<6, numbers::Abreast>&,
    const Vector<3, numbers::Abreast>&);

}  // namespace manutec_r3::arm
