// What a run leaves behind, and the solution anywhere in it.
#include "hybrid/trajectory.hpp"

#include <pybind11/stl.h>

#include <iterator>
#include <string>
#include <utility>

#include "bindings/bindings.hpp"
#include "robot/robot_system.hpp"
#include "solver/method.hpp"

namespace manutec_r3::bindings {
namespace {

using hybrid::Trajectory;
using Indices = py::array_t<py::ssize_t, py::array::c_style | py::array::forcecast>;

// The step that each instant falls into.
Indices steps_at(const Trajectory& trajectory, const Array& t) {
  Indices steps(t.size());
  for (py::ssize_t k = 0; k < t.size(); ++k) {
    steps.mutable_at(k) = static_cast<py::ssize_t>(trajectory.step_at(t.data()[k]));
  }
  return steps;
}

py::tuple as_state(const Trajectory& trajectory) {
  py::list modes;
  for (const hybrid::Mode& mode : trajectory.modes) {
    modes.append(py::make_tuple(mode.branches, mode.held));
  }
  std::vector<double> dense;
  for (const std::vector<double>& of_step : trajectory.dense) {
    dense.insert(dense.end(), of_step.begin(), of_step.end());
  }
  return py::make_tuple(as_array(trajectory.begin), as_array(trajectory.end), trajectory.mode,
                        as_array(dense), modes);
}

Trajectory from_state(const py::tuple& state) {
  Trajectory trajectory;
  trajectory.begin = as_vector(state[0].cast<Array>());
  trajectory.end = as_vector(state[1].cast<Array>());
  trajectory.mode = state[2].cast<std::vector<int>>();
  const auto dense = state[3].cast<Array>();
  const py::ssize_t size =
      trajectory.begin.empty() ? 0 : dense.size() / std::ssize(trajectory.begin);
  for (py::ssize_t k = 0; k < std::ssize(trajectory.begin); ++k) {
    trajectory.dense.emplace_back(dense.data() + k * size, dense.data() + (k + 1) * size);
  }
  for (const py::handle mode : state[4].cast<py::list>()) {
    const auto entries = mode.cast<py::tuple>();
    trajectory.modes.push_back(
        {entries[0].cast<std::vector<std::int32_t>>(), entries[1].cast<std::vector<double>>()});
  }
  return trajectory;
}

// The solution at instants t[k] inside steps step[k]: states (n, n_states), signals
// (n_signals, n, n_axes), branches (n_elements, n, n_axes).
py::tuple evaluate(std::shared_ptr<const robot::Robot> robot, const robot::Inputs& inputs,
                   solver::Method method, const Trajectory& trajectory, const Array& t,
                   const Indices& step) {
  const auto system = robot::make_system(std::move(robot), inputs);
  const auto inside = solver::make_dense_output(method, *system);
  const py::ssize_t n = t.size();
  const py::ssize_t n_axes = system->n_axes();
  const py::ssize_t n_states = system->n_states();
  constexpr py::ssize_t n_signals = robot::signal_names.size();
  Array states({n, n_states});
  Array signals({n_signals, n, n_axes});
  py::array_t<std::int8_t> branches({py::ssize_t{robot::n_axis_elements}, n, n_axes});
  {
    double* state = states.mutable_data();
    double* signal = signals.mutable_data();
    std::int8_t* branch = branches.mutable_data();
    const double* time = t.data();
    const py::ssize_t* in_step = step.data();
    const py::gil_scoped_release release;
    std::vector<double> at_instant(n_signals * n_axes);
    int mode = -1;
    for (py::ssize_t k = 0; k < n; ++k) {
      const hybrid::Step now = trajectory.step(in_step[k]);
      if (mode != trajectory.mode[in_step[k]]) {
        mode = trajectory.mode[in_step[k]];
        system->set_mode(trajectory.modes[mode]);
      }
      inside->evaluate(now, time[k], state + k * n_states);
      system->signals(time[k], state + k * n_states, at_instant.data());
      for (py::ssize_t i = 0; i < n_axes; ++i) {
        for (py::ssize_t s = 0; s < n_signals; ++s) {
          signal[(s * n + k) * n_axes + i] = at_instant[s * n_axes + i];
        }
        for (int kind = 0; kind < robot::n_axis_elements; ++kind) {
          branch[(kind * n + k) * n_axes + i] = static_cast<std::int8_t>(
              system->branch(static_cast<robot::ElementKind>(kind), static_cast<int>(i)));
        }
      }
    }
  }
  return py::make_tuple(states, signals, branches);
}

}  // namespace

void register_trajectory(py::module_& module) {
  py::list names;
  for (int kind = 0; kind < robot::n_axis_elements; ++kind) {
    names.append(std::string(robot::element_names[kind]));
  }
  module.attr("axis_elements") = py::tuple(names);

  py::class_<Trajectory, std::shared_ptr<Trajectory>>(module, "Trajectory")
      .def_property_readonly("begin", [](const Trajectory& t) { return as_array(t.begin); })
      .def_property_readonly("end", [](const Trajectory& t) { return as_array(t.end); })
      .def("steps_at", &steps_at)
      .def("until", &Trajectory::until)
      .def(py::pickle(&as_state, &from_state));
  module.def("evaluate", &evaluate);
}

}  // namespace manutec_r3::bindings
