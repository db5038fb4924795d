// A robot as a hybrid system, for integrators that are not ours: the contract of hybrid/system.hpp.
//
// Equations are evaluated at many instants at once: times (n,), states (n, n_states). The loop over
// them is in C++, so that time spent in Python does not hide theirs.
#include "hybrid/system.hpp"

#include <pybind11/stl.h>

#include <string>
#include <utility>

#include "bindings/bindings.hpp"
#include "robot/robot_system.hpp"

namespace manutec_r3::bindings {
namespace {

using robot::Robot;

class System {
 public:
  System(std::shared_ptr<const Robot> robot, const robot::Inputs& inputs)
      : system_(make_system(std::move(robot), inputs)) {}

  // The state after the decision about a start.
  Array initialise(double t, const Array& x) {
    Array decided = as_array(as_span(x));
    system_->initialise(t, decided.mutable_data());
    return decided;
  }

  Array derivatives(const Array& t, const Array& x) {
    return at_instants(
        t, x, system_->n_states(),
        [this](double t_k, const double* x_k, double* to) { system_->derivatives(t_k, x_k, to); });
  }
  Array indicators(const Array& t, const Array& x) {
    return at_instants(
        t, x, system_->n_indicators(),
        [this](double t_k, const double* x_k, double* to) { system_->indicators(t_k, x_k, to); });
  }
  // Each of them in the order of `signals`, n_axes values of each.
  Array signals(const Array& t, const Array& x) {
    return at_instants(
        t, x, robot::n_signals * system_->n_axes(),
        [this](double t_k, const double* x_k, double* to) { system_->signals(t_k, x_k, to); });
  }

  double next_time_event(double t) const { return system_->next_time_event(t); }

  // The state after the event, and what has switched: tuples (axis, element, before, after).
  py::tuple handle_event(double t, const Array& x, const std::vector<int>& fired, bool time_event) {
    Array decided = as_array(as_span(x));
    std::vector<hybrid::Change> changes;
    system_->handle_event(t, decided.mutable_data(),
                          {.fired = fired, .time_event = time_event, .input_changed = false},
                          changes);
    py::list switched;
    for (const auto& [element, before, after] : changes) {
      switched.append(py::make_tuple(element.axis, std::string(robot::element_names[element.kind]),
                                     before, after));
    }
    return py::make_tuple(decided, switched);
  }

 private:
  template <class Function>
  Array at_instants(const Array& t, const Array& x, int size, const Function& evaluate) {
    Array values({t.size(), py::ssize_t{size}});
    for (py::ssize_t k = 0; k < t.size(); ++k) {
      evaluate(t.data()[k], x.data() + k * system_->n_states(), values.mutable_data() + k * size);
    }
    return values;
  }

  std::unique_ptr<robot::RobotSystem> system_;
};

}  // namespace

void register_system(py::module_& module) {
  py::class_<System>(module, "System")
      .def(py::init<std::shared_ptr<const Robot>, const robot::Inputs&>())
      .def("initialise", &System::initialise)
      .def("derivatives", &System::derivatives)
      .def("indicators", &System::indicators)
      .def("signals", &System::signals)
      .def("next_time_event", &System::next_time_event)
      .def("handle_event", &System::handle_event);
}

}  // namespace manutec_r3::bindings
