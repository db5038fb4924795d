// Many runs on all processors: without the GIL, but for functions of the user's own, which take it.
#include <pybind11/native_enum.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cmath>
#include <exception>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "bindings/bindings.hpp"
#include "bindings/robot_options.hpp"
#include "bindings/simulator.hpp"
#include "bindings/trajectory.hpp"
#include "hybrid/simulation.hpp"
#include "robot/robot_system.hpp"
#include "robot/start.hpp"
#include "solver/method.hpp"
#include "workers/for_each.hpp"

namespace manutec_r3::bindings {
namespace {

using robot::Robot;
using Start = std::variant<robot::Start, std::vector<double>>;

// What is to be simulated, all of it checked.
struct Run {
  std::shared_ptr<const Robot> robot;
  robot::Inputs inputs;
  Start start;  // at rest on the reference, or a state
  double t_end;
  std::optional<std::vector<double>> times;  // instants to look for peaks at; default: all steps
  double rtol;
  solver::Method method;
  bool list_samples;
  // Inputs that are held from the start on.
  std::optional<std::vector<double>> input;
  std::optional<std::array<double, 3>> tip_force;
  std::vector<bool> brakes;
};

// Signals, and after them energies.
constexpr py::ssize_t n_rows = robot::n_signals + robot::n_energies;

// What is kept of a run. Trajectories take megabytes.
enum class Record { all, events, final, peaks };

// What came of a run: where it ended, why, and what is kept of it.
struct Outcome {
  bool began = false;
  double time = 0.0;
  std::vector<double> state;  // where it ended
  BranchesOfAxes branches;
  std::vector<hybrid::Event> events;
  hybrid::Statistics statistics;
  double seconds = 0.0;  // wall-clock
  std::shared_ptr<hybrid::Trajectory> trajectory;
  std::vector<double> final_state;  // the dense output at the end: the last row of a result
  std::vector<double> signals;      // (n_rows, n_axes)
  std::exception_ptr failure;       // if it could not begin, or not go on
};

// A run has been told to end.
struct Stopped {};

std::vector<double> start_of(const Run& run) {
  if (const auto* state = std::get_if<std::vector<double>>(&run.start)) return *state;
  return robot::rest_state(*run.robot, run.inputs.motion.get(), std::get<robot::Start>(run.start));
}

void set_held_inputs(const Run& run, robot::RobotSystem& system, hybrid::Simulation& simulation) {
  if (run.input) simulation.change_input([&] { system.set_input(*run.input); });
  if (run.tip_force) simulation.change_input([&] { system.set_tip_force(*run.tip_force); });
  if (std::ranges::find(run.brakes, true) != run.brakes.end()) {
    system.check_brakes(run.brakes, simulation.state().data());
    simulation.change_input([&] { system.set_brakes(run.brakes); });
  }
}

// The solution at instants of a finished run.
class Solutions {
 public:
  Solutions(robot::RobotSystem& system, hybrid::DenseOutput& inside,
            const hybrid::Trajectory& trajectory)
      : system_(system), inside_(inside), trajectory_(trajectory) {}

  // At n instants inside steps: keeps `states` (n, n_states) and `signals` (n_rows, n, n_axes).
  void evaluate_at(std::span<const double> times, std::span<const std::ptrdiff_t> steps) {
    const std::size_t n = times.size();
    const std::size_t n_axes = system_.n_axes();
    states.resize(n * system_.n_states());
    signals.resize(n_rows * n * n_axes);
    branches_.resize(robot::n_axis_elements * n * n_axes);
    const Instants instants{trajectory_, times, steps};
    evaluate(system_, inside_, instants, states.data(), branches_.data());
    evaluate_signals(system_, instants, states.data(), signals.data());
    evaluate_energies(system_, instants, states.data(), signals.data(),
                      &signals[robot::n_signals * n * n_axes]);
  }

  // The largest magnitude of each signal (n_rows, n_axes) at many instants.
  std::vector<double> peaks(const hybrid::Trajectory::Instants& instants) {
    constexpr std::size_t block = 32;  // instants at a time: as many as stay in the cache
    const std::size_t n_axes = system_.n_axes();
    std::vector<double> peaks(n_rows * n_axes, 0.0);
    for (std::size_t first = 0; first < instants.time.size(); first += block) {
      const std::size_t n = std::min(block, instants.time.size() - first);
      evaluate_at(std::span(instants.time).subspan(first, n),
                  std::span(instants.step).subspan(first, n));
      for (std::size_t row = 0; row < n_rows; ++row) {
        const double* now = &signals[row * n * n_axes];
        for (std::size_t k = 0; k < n; ++k) {
          for (std::size_t i = 0; i < n_axes; ++i, ++now) {
            double& peak = peaks[row * n_axes + i];
            const double magnitude = std::abs(*now);
            // A signal that the robot does not have is not a number.
            if (magnitude > peak || std::isnan(magnitude)) peak = magnitude;
          }
        }
      }
    }
    return peaks;
  }

  std::vector<double> states, signals;

 private:
  robot::RobotSystem& system_;
  hybrid::DenseOutput& inside_;
  const hybrid::Trajectory& trajectory_;
  std::vector<std::int8_t> branches_;
};

// Those that a result has.
hybrid::Trajectory::Instants instants(const Run& run, const hybrid::Simulation& simulation,
                                      const hybrid::Trajectory& trajectory) {
  std::vector<double> of_events;
  for (const hybrid::Event& event : simulation.events()) {
    if (of_events.empty() || event.time > of_events.back()) of_events.push_back(event.time);
  }
  if (!run.times) return trajectory.instants(of_events, {});
  std::vector<double> times = *run.times;
  std::erase_if(times, [&](double t) { return t > simulation.time(); });
  return trajectory.instants(of_events, times);
}

// Throws what ends a run before it has begun, and Stopped.
void simulate(const Run& run, Record record, const std::atomic<bool>& stop, Outcome& outcome) {
  outcome.state = start_of(run);
  const auto system = robot::make_system(run.robot, run.inputs);
  const auto integrator = solver::make_integrator(run.method, *system, run.rtol);
  const auto trajectory = std::make_shared<hybrid::Trajectory>();
  using hybrid::Simulation;
  Simulation simulation(
      *system, *integrator, 0.0, outcome.state,
      record == Record::events ? nullptr : trajectory.get(),
      run.list_samples ? Simulation::Routine::listed : Simulation::Routine::counted);
  set_held_inputs(run, *system, simulation);
  outcome.began = true;
  try {
    simulation.advance(run.t_end, Simulation::Stop::at_target, Simulation::Target::excluded,
                       [&](double) {
                         if (stop) throw Stopped();
                       });
  } catch (const Stopped&) {
    throw;
  } catch (...) {
    outcome.failure = std::current_exception();
  }
  outcome.time = simulation.time();
  outcome.statistics = simulation.statistics();
  outcome.state = simulation.state();
  outcome.branches = branches_of(*system);
  if (record == Record::all || record == Record::events) outcome.events = simulation.events();
  if (record == Record::events) return;

  trajectory->cut(outcome.time);
  Solutions solutions(*system, *integrator, *trajectory);
  if (record == Record::all) {
    outcome.trajectory = trajectory;
  } else if (record == Record::final) {
    const std::array end{outcome.time};
    const std::array last{static_cast<std::ptrdiff_t>(trajectory->step_at(outcome.time))};
    solutions.evaluate_at(end, last);
    outcome.final_state = solutions.states;
    outcome.signals = solutions.signals;
  } else {
    outcome.signals = solutions.peaks(instants(run, simulation, *trajectory));
  }
}

// Runs in their order, and what has come of those that are finished.
class Batch {
 public:
  Batch(std::vector<std::shared_ptr<const Run>> runs, Record record)
      : runs_(std::move(runs)), record_(record), outcomes_(runs_.size()) {}

  void run(int n_workers, const py::object& progress) {
    const auto task = [this](std::size_t k, const std::atomic<bool>& stop) {
      const auto began = std::chrono::steady_clock::now();
      auto outcome = std::make_shared<Outcome>();
      try {
        simulate(*runs_[k], record_, stop, *outcome);
      } catch (const Stopped&) {
        return;
      } catch (...) {
        outcome->failure = std::current_exception();
      }
      const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - began;
      outcome->seconds = elapsed.count();
      outcomes_[k] = std::move(outcome);
    };
    const auto look_up = [&](std::size_t n_done) {
      const py::gil_scoped_acquire acquire;
      if (PyErr_CheckSignals() != 0) throw py::error_already_set();
      if (!progress.is_none()) progress(n_done);
    };
    const py::gil_scoped_release release;
    workers::for_each(runs_.size(), n_workers, task, look_up);
  }

  // None where a run is not finished.
  const std::vector<std::shared_ptr<Outcome>>& outcomes() const { return outcomes_; }

 private:
  std::vector<std::shared_ptr<const Run>> runs_;
  Record record_;
  std::vector<std::shared_ptr<Outcome>> outcomes_;
};

std::shared_ptr<Run> make_run(std::shared_ptr<const Robot> robot, const robot::Inputs& inputs,
                              const py::object& start, double t_end,
                              std::optional<std::vector<double>> times, double rtol,
                              solver::Method method, bool list_samples,
                              std::optional<std::vector<double>> input,
                              std::optional<std::array<double, 3>> tip_force,
                              std::vector<bool> brakes) {
  Start named_or_state;
  if (py::isinstance<py::str>(start)) {
    named_or_state = start_named(start.cast<std::string>());
  } else {
    named_or_state = as_vector(start.cast<Array>());
  }
  return std::make_shared<Run>(Run{.robot = std::move(robot),
                                   .inputs = inputs,
                                   .start = std::move(named_or_state),
                                   .t_end = t_end,
                                   .times = std::move(times),
                                   .rtol = rtol,
                                   .method = method,
                                   .list_samples = list_samples,
                                   .input = std::move(input),
                                   .tip_force = tip_force,
                                   .brakes = std::move(brakes)});
}

}  // namespace

void register_many(py::module_& module) {
  py::class_<Run, std::shared_ptr<Run>>(module, "Run").def(py::init(&make_run));

  py::class_<Outcome, std::shared_ptr<Outcome>>(module, "Outcome")
      .def_property_readonly("failed", [](const Outcome& o) { return o.failure != nullptr; })
      .def_readonly("began", &Outcome::began)
      .def_readonly("time", &Outcome::time)
      .def_property_readonly("state", [](const Outcome& o) { return as_array(o.state); })
      .def_property_readonly("branches", [](const Outcome& o) { return as_dict(o.branches); })
      .def("events", [](const Outcome& o) { return as_list(o.events); })
      .def_property_readonly("statistics", [](const Outcome& o) { return as_dict(o.statistics); })
      .def_readonly("seconds", &Outcome::seconds)
      .def_readonly("trajectory", &Outcome::trajectory)
      .def_property_readonly("final_state",
                             [](const Outcome& o) { return as_array(o.final_state); })
      .def_property_readonly("signals",
                             [](const Outcome& o) {
                               const auto size = static_cast<py::ssize_t>(o.signals.size());
                               return Array({n_rows, size / n_rows}, o.signals.data());
                             })
      // Raises what ended the run, if something did.
      .def("raise_failure", [](const Outcome& o) {
        if (o.failure) std::rethrow_exception(o.failure);
      });

  py::native_enum<Record>(module, "Record", "enum.Enum")
      .value("all", Record::all)
      .value("events", Record::events)
      .value("final", Record::final)
      .value("peaks", Record::peaks)
      .finalize();

  py::class_<Batch>(module, "Batch")
      .def(py::init<std::vector<std::shared_ptr<const Run>>, Record>())
      .def("run", &Batch::run)
      .def_property_readonly("outcomes", &Batch::outcomes);
}

}  // namespace manutec_r3::bindings
