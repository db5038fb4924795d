// What a run leaves behind, and the solution anywhere in it.
#include "hybrid/trajectory.hpp"

#include <pybind11/stl.h>

#include <iterator>
#include <optional>
#include <string>
#include <utility>

#include "bindings/bindings.hpp"
#include "bindings/trajectory.hpp"
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
py::tuple solution_at(std::shared_ptr<const robot::Robot> robot, const robot::Inputs& inputs,
                      solver::Method method, const Trajectory& trajectory, const Array& t,
                      const Indices& step) {
  const auto system = robot::make_system(std::move(robot), inputs);
  const auto inside = solver::make_dense_output(method, *system);
  const py::ssize_t n = t.size();
  const py::ssize_t n_axes = system->n_axes();
  Array states({n, py::ssize_t{system->n_states()}});
  Array signals({py::ssize_t{robot::signal_names.size()}, n, n_axes});
  py::array_t<std::int8_t> branches({py::ssize_t{robot::n_axis_elements}, n, n_axes});
  {
    const std::span<const double> times = as_span(t);
    const std::span<const py::ssize_t> steps(step.data(), step.size());
    const Solution solution{states.mutable_data(), signals.mutable_data(), branches.mutable_data()};
    const py::gil_scoped_release release;
    evaluate(*system, *inside, trajectory, times, steps, solution);
  }
  return py::make_tuple(states, signals, branches);
}

// Instants to record (n,), and the step (n,) that each belongs to.
py::tuple instants(const Trajectory& trajectory, const Array& event_times,
                   const std::optional<Array>& times) {
  const auto [time, step] = trajectory.instants(
      as_span(event_times), times ? std::optional(as_span(*times)) : std::nullopt);
  return py::make_tuple(as_array(time), Indices(step.size(), step.data()));
}

}  // namespace

void evaluate(robot::RobotSystem& system, hybrid::DenseOutput& inside, const Trajectory& trajectory,
              std::span<const double> times, std::span<const std::ptrdiff_t> steps,
              const Solution& solution) {
  const std::size_t n = times.size();
  const std::size_t n_axes = system.n_axes();
  const std::size_t n_states = system.n_states();
  constexpr std::size_t n_signals = robot::signal_names.size();
  std::vector<double> at_instant(n_signals * n_axes);
  int mode = -1;
  for (std::size_t k = 0; k < n; ++k) {
    const hybrid::Step now = trajectory.step(steps[k]);
    if (mode != trajectory.mode[steps[k]]) {
      mode = trajectory.mode[steps[k]];
      system.set_mode(trajectory.modes[mode]);
      inside.mode_changed();
    }
    inside.evaluate(now, times[k], solution.states + k * n_states);
    system.signals(times[k], solution.states + k * n_states, at_instant.data());
    for (std::size_t i = 0; i < n_axes; ++i) {
      for (std::size_t s = 0; s < n_signals; ++s) {
        solution.signals[(s * n + k) * n_axes + i] = at_instant[s * n_axes + i];
      }
      for (int kind = 0; kind < robot::n_axis_elements; ++kind) {
        solution.branches[(kind * n + k) * n_axes + i] = static_cast<std::int8_t>(
            system.branch(static_cast<robot::ElementKind>(kind), static_cast<int>(i)));
      }
    }
  }
}

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
      .def("instants", &instants)
      .def(py::pickle(&as_state, &from_state));
  module.def("evaluate", &solution_at);
}

}  // namespace manutec_r3::bindings
