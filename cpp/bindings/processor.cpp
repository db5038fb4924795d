// The extension module manutec_r3._processor: which of the builds the processor at hand can run.
// It is compiled for the baseline processor and loaded before any of them.
#include <pybind11/pybind11.h>

namespace py = pybind11;

PYBIND11_MODULE(_processor, module) {
  module.doc() = "Which builds of the core the processor at hand can run.";
  py::list builds;
  builds.append("baseline");
#ifdef MANUTEC_R3_X86_64_V3
  if (__builtin_cpu_supports("x86-64-v3")) builds.append("x86-64-v3");
#endif
  module.attr("builds") = py::tuple(builds);
}
