// The elements that switch, by name (spec 8). Events of one instant are told in this order: the
// reference, the sample, then axis by axis the elements as they stand below.
#pragma once

#include <array>
#include <string_view>

namespace manutec_r3::robot {

enum ElementKind { dead_zone, torque_limit, voltage_limit, backlash, friction, reference, sample };

inline constexpr std::array<std::string_view, 7> element_names = {
    "dead_zone", "torque_limit", "voltage_limit", "backlash", "friction", "reference", "sample"};

// Elements that every axis has, or counts as having with branch 0.
inline constexpr int n_axis_elements = 5;

}  // namespace manutec_r3::robot
