// What a run leaves behind, and the solution anywhere in it.
#include "hybrid/trajectory.hpp"

#include <pybind11/stl.h>

#include <algorithm>
#include <cstdint>
#include <iterator>
#include <optional>
#include <stdexcept>
#include <string>
#include <type_traits>
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

using Counts = py::array_t<std::int32_t, py::array::c_style | py::array::forcecast>;

// A list of rows as an array (n_rows, size).
template <class Table>
auto as_table(std::size_t n_rows, const Table& row) {
  using Number = std::remove_cvref_t<decltype(row(0)[0])>;
  const std::size_t size = n_rows == 0 ? 0 : row(0).size();
  py::array_t<Number> table({n_rows, size});
  for (std::size_t k = 0; k < n_rows; ++k)
    std::ranges::copy(row(k), table.mutable_data() + k * size);
  return table;
}

template <class Table>
auto row(const Table& table, py::ssize_t k) {
  const auto* begin = table.data() + k * table.shape(1);
  return std::vector(begin, begin + table.shape(1));
}

// One number of each step (n_steps,).
Array of_steps(const Trajectory& trajectory, double hybrid::Step::* number) {
  Array numbers(std::ssize(trajectory.steps));
  std::ranges::transform(trajectory.steps, numbers.mutable_data(), number);
  return numbers;
}

// All of it as arrays, for who keeps it: begin, end, mode of each step (n_steps,), its dense output
// (n_steps, size); branches and held values of each mode (n_modes, ...).
py::tuple parts(const Trajectory& trajectory) {
  const auto& [steps, mode, modes] = trajectory;
  return py::make_tuple(
      of_steps(trajectory, &hybrid::Step::t0), of_steps(trajectory, &hybrid::Step::t1),
      Counts(std::ssize(mode), mode.data()),
      as_table(steps.size(), [&](std::size_t k) -> const auto& { return steps[k].dense; }),
      as_table(modes.size(), [&](std::size_t k) -> const auto& { return modes[k].branches; }),
      as_table(modes.size(), [&](std::size_t k) -> const auto& { return modes[k].held; }));
}

Trajectory from_parts(const Array& begin, const Array& end, const Counts& mode, const Array& dense,
                      const Counts& branches, const Array& held) {
  const py::ssize_t n_steps = begin.size();
  const bool fit = begin.ndim() == 1 && end.ndim() == 1 && mode.ndim() == 1 && dense.ndim() == 2 &&
                   branches.ndim() == 2 && held.ndim() == 2 && end.size() == n_steps &&
                   mode.size() == n_steps && dense.shape(0) == n_steps &&
                   branches.shape(0) == held.shape(0);
  if (!fit) throw std::invalid_argument("steps and modes: expected arrays that fit each other");
  Trajectory trajectory;
  trajectory.mode = {mode.data(), mode.data() + n_steps};
  const auto n_modes = static_cast<int>(held.shape(0));
  for (const int of_step : trajectory.mode) {
    if (of_step < 0 || of_step >= n_modes) {
      throw std::invalid_argument("mode of a step: expected a number below " +
                                  std::to_string(n_modes) + ", got " + std::to_string(of_step));
    }
  }
  for (py::ssize_t k = 0; k < n_steps; ++k) {
    trajectory.steps.push_back({begin.at(k), end.at(k), row(dense, k)});
  }
  for (int k = 0; k < n_modes; ++k) trajectory.modes.push_back({row(branches, k), row(held, k)});
  return trajectory;
}

Instants as_instants(const Trajectory& trajectory, const Array& t, const Indices& step) {
  return {trajectory, as_span(t), {step.data(), static_cast<std::size_t>(step.size())}};
}

// States (n, n_states) and branches (n_elements, n, n_axes) at instants t[k] inside steps step[k].
py::tuple solution_at(std::shared_ptr<const robot::Robot> robot, const robot::Inputs& inputs,
                      solver::Method method, double rtol, const Trajectory& trajectory,
                      const Array& t, const Indices& step) {
  const auto system = robot::make_system(std::move(robot), inputs);
  const auto inside = solver::make_dense_output(method, *system, rtol);
  const py::ssize_t n = t.size();
  Array states({n, py::ssize_t{system->n_states()}});
  py::array_t<std::int8_t> branches(
      {py::ssize_t{robot::n_axis_elements}, n, py::ssize_t{system->n_axes()}});
  {
    double* to_states = states.mutable_data();
    std::int8_t* to_branches = branches.mutable_data();
    const Instants instants = as_instants(trajectory, t, step);
    const py::gil_scoped_release release;
    evaluate(*system, *inside, instants, to_states, to_branches);
  }
  return py::make_tuple(states, branches);
}

// What follows from the states (n, n_states) there: signals (n_signals, n, n_axes).
Array signals_at(std::shared_ptr<const robot::Robot> robot, const robot::Inputs& inputs,
                 const Trajectory& trajectory, const Array& t, const Indices& step,
                 const Array& states) {
  const auto system = robot::make_system(std::move(robot), inputs);
  Array signals({py::ssize_t{robot::n_signals}, t.size(), py::ssize_t{system->n_axes()}});
  double* to_signals = signals.mutable_data();
  const Instants instants = as_instants(trajectory, t, step);
  const py::gil_scoped_release release;
  evaluate_signals(*system, instants, states.data(), to_signals);
  return signals;
}

// And what follows from these: energies (n_energies, n, n_axes).
Array energies_at(std::shared_ptr<const robot::Robot> robot, const robot::Inputs& inputs,
                  const Trajectory& trajectory, const Array& t, const Indices& step,
                  const Array& states, const Array& signals) {
  const auto system = robot::make_system(std::move(robot), inputs);
  Array energies({py::ssize_t{robot::n_energies}, t.size(), py::ssize_t{system->n_axes()}});
  double* to_energies = energies.mutable_data();
  const Instants instants = as_instants(trajectory, t, step);
  const py::gil_scoped_release release;
  evaluate_energies(*system, instants, states.data(), signals.data(), to_energies);
  return energies;
}

// Instants to record (n,), and the step (n,) that each belongs to.
py::tuple instants_of(const Trajectory& trajectory, const Array& event_times,
                      const std::optional<Array>& times) {
  const auto [time, step] = trajectory.instants(
      as_span(event_times), times ? std::optional(as_span(*times)) : std::nullopt);
  return py::make_tuple(as_array(time), Indices(step.size(), step.data()));
}

// Calls visit(k) at each instant k, with the system in the mode of its step; calls changed() when
// that is another mode than before.
template <class Changed, class Visit>
void at_each(robot::RobotSystem& system, const Instants& instants, const Changed& changed,
             const Visit& visit) {
  const Trajectory& trajectory = instants.trajectory;
  int mode = -1;
  for (std::size_t k = 0; k < instants.times.size(); ++k) {
    if (mode != trajectory.mode[instants.steps[k]]) {
      mode = trajectory.mode[instants.steps[k]];
      system.set_mode(trajectory.modes[mode]);
      changed();
    }
    visit(k);
  }
}

// Where row `row` of instant k begins among the rows (n_rows, n, n_axes) of all instants.
std::size_t place(std::size_t row, std::size_t k, const Instants& instants, std::size_t n_axes) {
  return (row * instants.times.size() + k) * n_axes;
}

}  // namespace

void evaluate(robot::RobotSystem& system, hybrid::DenseOutput& inside, const Instants& instants,
              double* states, std::int8_t* branches) {
  const std::size_t n = instants.times.size();
  const std::size_t n_axes = system.n_axes();
  at_each(
      system, instants, [&] { inside.mode_changed(); },
      [&](std::size_t k) {
        inside.interpolate(instants.trajectory.stretch(instants.steps[k]), instants.times[k],
                           states + k * system.n_states());
        for (std::size_t i = 0; i < n_axes; ++i) {
          for (int kind = 0; kind < robot::n_axis_elements; ++kind) {
            branches[(kind * n + k) * n_axes + i] = static_cast<std::int8_t>(
                system.branch(static_cast<robot::ElementKind>(kind), static_cast<int>(i)));
          }
        }
      });
}

void evaluate_signals(robot::RobotSystem& system, const Instants& instants, const double* states,
                      double* signals) {
  const std::size_t n_axes = system.n_axes();
  std::vector<double> now(robot::n_signals * n_axes);
  at_each(
      system, instants, [] {},
      [&](std::size_t k) {
        system.signals(instants.times[k], states + k * system.n_states(), now.data());
        for (std::size_t row = 0; row < robot::n_signals; ++row) {
          std::copy_n(&now[row * n_axes], n_axes, signals + place(row, k, instants, n_axes));
        }
      });
}

void evaluate_energies(robot::RobotSystem& system, const Instants& instants, const double* states,
                       const double* signals, double* energies) {
  const std::size_t n_axes = system.n_axes();
  std::vector<double> signals_now(robot::n_signals * n_axes), now(robot::n_energies * n_axes);
  at_each(
      system, instants, [] {},
      [&](std::size_t k) {
        for (std::size_t row = 0; row < robot::n_signals; ++row) {
          std::copy_n(signals + place(row, k, instants, n_axes), n_axes,
                      &signals_now[row * n_axes]);
        }
        system.energies(states + k * system.n_states(), signals_now.data(), now.data());
        for (std::size_t row = 0; row < robot::n_energies; ++row) {
          std::copy_n(&now[row * n_axes], n_axes, energies + place(row, k, instants, n_axes));
        }
      });
}

void register_trajectory(py::module_& module) {
  py::list names;
  for (int kind = 0; kind < robot::n_axis_elements; ++kind) {
    names.append(std::string(robot::element_names[kind]));
  }
  module.attr("axis_elements") = py::tuple(names);

  py::class_<Trajectory, std::shared_ptr<Trajectory>>(module, "Trajectory")
      .def_property_readonly("begin",
                             [](const Trajectory& t) { return of_steps(t, &hybrid::Step::t0); })
      .def_property_readonly("end",
                             [](const Trajectory& t) { return of_steps(t, &hybrid::Step::t1); })
      .def("steps_at", &steps_at)
      .def("until", &Trajectory::until)
      .def("instants", &instants_of)
      .def(py::init(&from_parts))
      .def_property_readonly("parts", &parts)
      .def("__reduce__", [](const py::object& self) {
        return py::make_tuple(py::type::of(self), self.attr("parts"));
      });
  module.def("evaluate", &solution_at);
  module.def("evaluate_signals", &signals_at);
  module.def("evaluate_energies", &energies_at);
}

}  // namespace manutec_r3::bindings
