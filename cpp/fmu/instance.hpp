// One instance of an exported robot: the contract of a hybrid system (hybrid/system.hpp) as FMI
// sees it. fmi/ says it in C, for two versions of the standard.
//
// Model Exchange: the importer integrates. It sets time and states, reads derivatives and
// indicators, all on frozen branches, and at events has the discrete states updated. Every
// indicator is positive on the present branches; one that is not at an event has fired. The
// decision counts all of them as inside their domains (semantics 2 of hybrid/simulation.hpp):
// those that stand at zero then, such as the rate of an axis that has just broken away, are lifted
// by a constant until the next event, so that none is ever left at exactly zero.
//
// Co-Simulation: the FMU integrates itself, with the simulation loop of hybrid/simulation.hpp.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "fmu/recipe.hpp"
#include "fmu/variables.hpp"
#include "hybrid/simulation.hpp"
#include "robot/robot_system.hpp"

namespace manutec_r3::fmu {

enum class Kind { model_exchange, co_simulation };

// All that the future of an instance depends on.
struct SavedState {
  // Of the importer's side: which FMU, and where in the order of calls.
  std::string token = {};
  Kind kind = Kind::model_exchange;
  unsigned phase = 0;
  double stop_time = hybrid::never;

  std::vector<double> row;  // of all numbers; states, parameters and inputs among them
  double tolerance = 0.0;
  bool initialising = true;
  bool started = false;
  double reference_since = 0.0;
  bool input_changed = false;
  // Model Exchange
  hybrid::Mode mode;
  std::vector<double> given, lift;
  std::vector<int> fired;
  double latest_event = 0.0;
  // Co-Simulation
  std::optional<hybrid::Simulation::Snapshot> simulation;
};

std::vector<unsigned char> bytes_of(const SavedState& saved);
// Throws std::invalid_argument if they are none of these.
SavedState saved_state_from(std::span<const unsigned char> bytes);

class Instance {
 public:
  // What the importer is told about an event.
  using Report = std::function<void(const std::string& message)>;

  Instance(Recipe recipe, Kind kind, Report report);

  const std::vector<Variable>& variables() const { return variables_; }
  int n_states() const { return static_cast<int>(group(Group::state).size()); }
  int n_indicators() const { return static_cast<int>(group(Group::indicator).size()); }

  // --- variables ---------------------------------------------------------------------------------

  // The variable that a value reference belongs to. Throws std::invalid_argument.
  const Variable& variable(unsigned reference) const;
  // Numbers `first` to `first` + values.size() of the row, as they are at this instant.
  void get(int first, std::span<double> values);
  // Throws std::invalid_argument for what cannot be set, and for what is not finite.
  enum class States { follow, can_be_set };
  void check(int first, std::span<const double> values, States states) const;
  // What has been checked.
  void set(int first, std::span<const double> values);

  // --- initialisation ----------------------------------------------------------------------------

  // Until it ends parameters can be set, and the start follows from what has been set. Throws
  // std::invalid_argument if that is no robot, or if the robot cannot start so.
  void end_initialisation();
  // Relative, of Co-Simulation. Throws std::invalid_argument.
  void set_tolerance(double tolerance);

  // --- Model Exchange ----------------------------------------------------------------------------

  void set_time(double t);
  void set_states(std::span<const double> x);
  std::span<const double> states();
  std::vector<double> nominals() const;
  void derivatives(std::span<double> values);
  void indicators(std::span<double> values);

  // The samples of the position controllers are time events, and may be ticks of a clock as well:
  // what ticks has come, however the importer rounds its instant. Throws std::invalid_argument if
  // there is no sample at this instant.
  void tick();
  double sampling_time() const;

  // Finds out which indicators have fired at this instant.
  void enter_event();
  double latest_event() const { return latest_event_; }
  struct Update {
    bool states_changed = false;
    double next_time_event = hybrid::never;
  };
  // The decision. It is the fixed point: another update at this instant changes nothing.
  Update update_discrete_states();

  // How unknowns move where the knowns move by `seed`, on frozen branches: by differences.
  void directional_derivative(std::span<const int> unknowns, std::span<const int> knowns,
                              std::span<const double> seed, std::span<double> sensitivity);

  // --- Co-Simulation -----------------------------------------------------------------------------

  double time() const { return row_[0]; }
  enum class Stop { at_target, at_event };
  // Called with the time after each step of the integration; returns until when it is to go on.
  using LookUp = std::function<double(double t)>;
  // Advances to t, or to the first event, which then waits for update_discrete_states(), or to
  // where `look_up` says. Returns whether an event waits. Throws hybrid::SimulationFailure.
  bool advance(double t, Stop stop, const LookUp& look_up);

  SavedState save() const;
  // Of the same FMU and of the same kind.
  void restore(const SavedState& saved);

 private:
  struct Reference;  // of the position controllers, where it is an input

  void start();
  void build();
  void begin_simulation(const std::vector<double>& x);
  void synchronise();
  void refresh();
  void read_reference();
  void put_inputs();
  void change_inputs();
  void report_changes(double t, std::span<const hybrid::Change> changes);
  void report_new_events();
  void evaluate_indicators(double* values);
  void lift_indicators();
  std::span<double> group(Group which);
  std::span<const double> group(Group which) const;

  Recipe recipe_;
  Kind kind_;
  Report report_;
  std::vector<Variable> variables_;
  std::vector<int> first_;  // of each group, and the end
  std::vector<double> row_;
  double tolerance_;
  bool initialising_ = true;
  bool started_ = false;            // with the present parameters
  bool stale_ = true;               // what follows from the state
  std::vector<double> parameters_;  // of the present system
  std::shared_ptr<Reference> reference_;
  std::unique_ptr<robot::RobotSystem> system_;
  // Model Exchange
  std::vector<double> given_;      // states that the importer has
  std::vector<double> magnitude_;  // of indicators
  std::vector<double> lift_;
  std::vector<int> fired_;
  double latest_event_ = 0.0;
  bool input_changed_ = false;
  // Co-Simulation
  std::unique_ptr<hybrid::Integrator> integrator_;
  std::unique_ptr<hybrid::Simulation> simulation_;
  std::size_t n_reported_ = 0;  // of its events
};

}  // namespace manutec_r3::fmu
