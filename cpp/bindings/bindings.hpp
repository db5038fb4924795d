// What the binding files share: one registration function per room, and arrays at the border.
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <memory>
#include <span>
#include <vector>

#include "motion/motion.hpp"

namespace manutec_r3::bindings {

namespace py = pybind11;

// C-contiguous and of doubles, converted if necessary. The Python side has refused what are not
// finite numbers, and shapes that would not fit.
using Array = py::array_t<double, py::array::c_style | py::array::forcecast>;

inline std::span<const double> as_span(const Array& array) {
  return {array.data(), static_cast<std::size_t>(array.size())};
}

inline std::vector<double> as_vector(const Array& array) {
  return {array.data(), array.data() + array.size()};
}

inline Array as_array(std::span<const double> values) {
  return Array(static_cast<py::ssize_t>(values.size()), values.data());
}

void register_tables(py::module_& module);
void register_motion(py::module_& module);
void register_inputs(py::module_& module);
void register_robot(py::module_& module);
void register_arm(py::module_& module);
void register_system(py::module_& module);
void register_simulator(py::module_& module);
void register_trajectory(py::module_& module);
void register_many(py::module_& module);
void register_fmu(py::module_& module);
void register_build(py::module_& module);

}  // namespace manutec_r3::bindings
