// What a simulation tells, as Python has it.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "bindings/bindings.hpp"
#include "hybrid/simulation.hpp"
#include "robot/robot_system.hpp"

namespace manutec_r3::bindings {

// The branch of each element on each axis.
using BranchesOfAxes = std::array<std::vector<std::int8_t>, robot::n_axis_elements>;
BranchesOfAxes branches_of(const robot::RobotSystem& system);

// By the names of the elements.
py::dict as_dict(const BranchesOfAxes& branches);
// Tuples (time, axis, element, before, after).
py::list as_list(std::span<const hybrid::Event> events);
py::dict as_dict(const hybrid::Statistics& statistics);

}  // namespace manutec_r3::bindings
