// The extension modules manutec_r3._core_*, one for each processor that there is a build for: a
// table of contents.
#include "bindings/bindings.hpp"

PYBIND11_MODULE(MANUTEC_R3_MODULE, module) {
  module.doc() = "The compiled core of manutec_r3; the package wraps it.";
  // What is pickled on one processor is unpickled on any other: classes are known by the name of
  // the Python module that shows those of the build in use.
  module.attr("__module__") = "manutec_r3._core";
  using namespace manutec_r3::bindings;
  register_tables(module);
  register_motion(module);
  register_inputs(module);
  register_robot(module);
  register_arm(module);
  register_system(module);
  register_simulator(module);
  register_trajectory(module);
  register_many(module);
  register_fmu(module);
  register_build(module);
}
