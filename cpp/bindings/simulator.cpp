// A robot, a motion and an integrator in one object that Python steps.
#include "bindings/simulator.hpp"

#include <pybind11/native_enum.h>
#include <pybind11/stl.h>

#include <chrono>
#include <cmath>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

#include "bindings/bindings.hpp"
#include "hybrid/failure.hpp"
#include "hybrid/simulation.hpp"
#include "robot/robot_system.hpp"
#include "solver/method.hpp"

namespace manutec_r3::bindings {
namespace {

using robot::Robot;

// Between two looks at signals and progress: often enough for a person, too seldom to be noticed.
constexpr std::chrono::milliseconds look_up_interval(50);

// As tuples (name, unit, description).
py::tuple as_tuple(std::span<const robot::SignalDescription> descriptions) {
  py::list list;
  for (const auto& [_, name, unit, text] : descriptions) {
    list.append(py::make_tuple(name, unit, text));
  }
  return list;
}

class Simulator {
 public:
  Simulator(std::shared_ptr<const Robot> robot, const robot::Inputs& inputs, const Array& start,
            double rtol, solver::Method method, bool record, bool list_samples)
      : trajectory_(std::make_shared<hybrid::Trajectory>()),
        system_(make_system(std::move(robot), inputs)),
        integrator_(make_integrator(method, *system_, rtol)),
        simulation_(*system_, *integrator_, 0.0, as_vector(start),
                    record ? trajectory_.get() : nullptr,
                    list_samples ? hybrid::Simulation::Routine::listed
                                 : hybrid::Simulation::Routine::counted) {}

  void advance(double target, bool stop_at_event, bool include_target, const py::object& progress) {
    auto latest = std::chrono::steady_clock::now();
    const auto look_up = [&](double t) {
      const auto now = std::chrono::steady_clock::now();
      if (now - latest < look_up_interval) return;
      latest = now;
      const py::gil_scoped_acquire acquire;
      if (PyErr_CheckSignals() != 0) throw py::error_already_set();
      if (!progress.is_none()) progress(t);
    };
    const py::gil_scoped_release release;
    using hybrid::Simulation;
    simulation_.advance(
        target, stop_at_event ? Simulation::Stop::at_first_event : Simulation::Stop::at_target,
        include_target ? Simulation::Target::included : Simulation::Target::excluded, look_up);
  }

  void set_input(const Array& values) {
    simulation_.change_input([&] { system_->set_input(as_span(values)); });
  }
  void set_tip_force(const std::array<double, 3>& force) {
    simulation_.change_input([&] { system_->set_tip_force(force); });
  }
  void set_brakes(const std::vector<bool>& on) {
    const std::vector<double> x = simulation_.state();
    system_->check_brakes(on, x.data());
    simulation_.change_input([&] { system_->set_brakes(on); });
  }
  std::vector<bool> brakes() const { return system_->brakes(); }
  Array input() const { return as_array(system_->input()); }
  Array tip_force() const { return as_array(system_->tip_force()); }

  double time() const { return simulation_.time(); }
  Array state() { return as_array(simulation_.state()); }

  // (n_signals, n_axes).
  Array signals() {
    Array values({py::ssize_t{robot::n_signals}, py::ssize_t{system_->n_axes()}});
    system_->signals(time(), simulation_.state().data(), values.mutable_data());
    return values;
  }
  // (n_energies, n_axes).
  Array energies() {
    Array values({py::ssize_t{robot::n_energies}, py::ssize_t{system_->n_axes()}});
    system_->energies(simulation_.state().data(), signals().data(), values.mutable_data());
    return values;
  }

  py::dict branches() const { return as_dict(branches_of(*system_)); }

  std::size_t n_events() const { return simulation_.events().size(); }
  // From number `first` on.
  py::list events(std::size_t first) const {
    return as_list(std::span(simulation_.events()).subspan(first));
  }

  py::dict statistics() const { return as_dict(simulation_.statistics()); }

  hybrid::Simulation::Snapshot save() const { return simulation_.save(); }
  void restore(const hybrid::Simulation::Snapshot& snapshot) { simulation_.restore(snapshot); }

  // The record itself, not a copy, of a run that has come to its end: the part of the last step
  // that lies ahead is left out.
  std::shared_ptr<hybrid::Trajectory> trajectory() {
    trajectory_->cut(time());
    return trajectory_;
  }

 private:
  std::shared_ptr<hybrid::Trajectory> trajectory_;
  std::unique_ptr<robot::RobotSystem> system_;
  std::unique_ptr<hybrid::Integrator> integrator_;
  hybrid::Simulation simulation_;
};

}  // namespace

BranchesOfAxes branches_of(const robot::RobotSystem& system) {
  BranchesOfAxes branches;
  for (int kind = 0; kind < robot::n_axis_elements; ++kind) {
    for (int i = 0; i < system.n_axes(); ++i) {
      branches[kind].push_back(
          static_cast<std::int8_t>(system.branch(static_cast<robot::ElementKind>(kind), i)));
    }
  }
  return branches;
}

py::dict as_dict(const BranchesOfAxes& branches) {
  py::dict dict;
  for (int kind = 0; kind < robot::n_axis_elements; ++kind) {
    const std::vector<std::int8_t>& of_axes = branches[kind];
    dict[py::str(std::string(robot::element_names[kind]))] =
        py::array_t<std::int8_t>(static_cast<py::ssize_t>(of_axes.size()), of_axes.data());
  }
  return dict;
}

py::list as_list(std::span<const hybrid::Event> events) {
  py::list list;
  for (const hybrid::Event& event : events) {
    list.append(py::make_tuple(event.time, event.element.axis,
                               std::string(robot::element_names[event.element.kind]), event.before,
                               event.after));
  }
  return list;
}

py::dict as_dict(const hybrid::Statistics& statistics) {
  py::dict counts;
  counts["evaluations"] = statistics.work.evaluations;
  counts["steps"] = statistics.work.steps;
  counts["rejected_steps"] = statistics.work.rejected_steps;
  counts["events"] = statistics.events;
  counts["restarts"] = statistics.restarts;
  counts["samples"] = statistics.routine_events;
  counts["sample_evaluations"] = statistics.routine_evaluations;
  return counts;
}

void register_simulator(py::module_& module) {
  py::register_exception<hybrid::SimulationFailure>(module, "SimulationFailure",
                                                    PyExc_RuntimeError);

  py::native_enum<solver::Method>(module, "Method", "enum.Enum")
      .value("erk", solver::Method::erk)
      .value("bdf", solver::Method::bdf)
      .value("exponential", solver::Method::exponential)
      .finalize();
  module.def("default_tolerance", &solver::default_tolerance);
  module.attr("signals") = as_tuple(robot::signal_descriptions);
  module.attr("energies") = as_tuple(robot::energy_descriptions);

  py::class_<hybrid::Simulation::Snapshot>(module, "Snapshot");

  py::class_<Simulator>(module, "Simulator")
      .def(py::init<std::shared_ptr<const Robot>, const robot::Inputs&, const Array&, double,
                    solver::Method, bool, bool>())
      .def("advance", &Simulator::advance)
      .def("set_input", &Simulator::set_input)
      .def("set_tip_force", &Simulator::set_tip_force)
      .def("set_brakes", &Simulator::set_brakes)
      .def_property_readonly("brakes", &Simulator::brakes)
      .def_property_readonly("input", &Simulator::input)
      .def_property_readonly("tip_force", &Simulator::tip_force)
      .def_property_readonly("time", &Simulator::time)
      .def_property_readonly("state", &Simulator::state)
      .def_property_readonly("signals", &Simulator::signals)
      .def_property_readonly("energies", &Simulator::energies)
      .def_property_readonly("branches", &Simulator::branches)
      .def_property_readonly("n_events", &Simulator::n_events)
      .def("events", &Simulator::events)
      .def_property_readonly("statistics", &Simulator::statistics)
      .def("save", &Simulator::save)
      .def("restore", &Simulator::restore)
      .def_property_readonly("trajectory", &Simulator::trajectory);
}

}  // namespace manutec_r3::bindings
