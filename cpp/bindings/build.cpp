// How this build of the core was made. CMakeLists.txt defines what only CMake knows.
#include <Eigen/Core>
#include <string>

#include "bindings/bindings.hpp"
#include "solver/propagator.hpp"
#include "solver/version.hpp"

namespace manutec_r3::bindings {

void register_build(py::module_& module) {
  module.attr("processor") = MANUTEC_R3_PROCESSOR;
  module.attr("compiler") = MANUTEC_R3_COMPILER;
  module.attr("compiler_flags") = MANUTEC_R3_COMPILER_FLAGS;
  module.attr("eigen_version") = std::to_string(EIGEN_WORLD_VERSION) + "." +
                                 std::to_string(EIGEN_MAJOR_VERSION) + "." +
                                 std::to_string(EIGEN_MINOR_VERSION);
  module.attr("sundials_version") = solver::sundials_version();
  module.def("forget_propagators", &solver::forget_propagators,
             "Make the exponential method begin as in a new process, for measurements.");
}

}  // namespace manutec_r3::bindings
