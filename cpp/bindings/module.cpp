// The extension module manutec_r3._core: a table of contents.
#include "bindings/bindings.hpp"

PYBIND11_MODULE(_core, module) {
  module.doc() = "The compiled core of manutec_r3; the package wraps it.";
  using namespace manutec_r3::bindings;
  register_tables(module);
  register_motion(module);
  register_inputs(module);
  register_robot(module);
  register_arm(module);
  register_system(module);
  register_simulator(module);
  register_trajectory(module);
}
