// What acts on a robot from outside as a function of time: Python functions among it.
#include "robot/inputs.hpp"

#include <pybind11/functional.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <utility>

#include "bindings/bindings.hpp"

namespace manutec_r3::bindings {

void register_inputs(py::module_& module) {
  using motion::Input;
  // The function takes the time and returns `size` numbers, which the Python side has checked. It
  // is called, and given up, under the lock of the interpreter: pybind11 sees to both.
  using Function = std::function<std::vector<double>(double)>;
  py::class_<Input, std::shared_ptr<Input>>(module, "Input")
      .def(py::init([](int size, const Function& function, const Array& knots) {
        const auto write = [function](double t, double* values) {
          std::ranges::copy(function(t), values);
        };
        return std::make_shared<Input>(size, write, as_vector(knots));
      }));

  py::class_<robot::Inputs>(module, "Inputs")
      .def(py::init([](std::shared_ptr<const motion::Motion> motion,
                       std::shared_ptr<const Input> of_axes,
                       std::shared_ptr<const Input> tip_force) {
        return robot::Inputs{std::move(motion), std::move(of_axes), std::move(tip_force)};
      }));
}

}  // namespace manutec_r3::bindings
