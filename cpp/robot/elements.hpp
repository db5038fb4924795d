// The elements that switch, by name (spec 8). Events of one instant are told in this order: the
// reference, then axis by axis the elements as they stand below.
#pragma once

#include <array>
#include <string_view>

namespace manutec_r3::robot {

enum ElementKind { dead_zone, torque_limit, backlash, friction, reference };

inline constexpr std::array<std::string_view, 5> element_names = {
    "dead_zone", "torque_limit", "backlash", "friction", "reference"};

// Elements that every axis has, or counts as having with branch 0.
inline constexpr int n_axis_elements = 4;

}  // namespace manutec_r3::robot
