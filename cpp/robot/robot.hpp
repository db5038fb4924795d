// What is simulated, immutable: one of the four DLR models (spec 7; report Table 4) or of the two
// Modelica ones, with its load, its options and its tables.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "arm/load.hpp"
#include "arm/mechanism.hpp"
#include "drive/parameters.hpp"
#include "motion/motion.hpp"
#include "robot/elements.hpp"
#include "robot/linear_blocks.hpp"
#include "robot/options.hpp"
#include "robot/tables.hpp"

namespace manutec_r3::robot {

// A group of states: one quantity, axis fastest.
struct StateGroup {
  std::string name;
  std::string unit;
  std::vector<double> nominals;  // magnitude on each axis, by which tolerances are scaled
  int first;
  int size;
};

struct IndicatorGroup {
  std::string name;
  int first;
  int size;  // two for each axis: the upper and the lower side
};

class Robot {
 public:
  // Throws std::invalid_argument: the load within its bounds, options that the model has, tables
  // that describe a robot.
  Robot(Model model, const arm::Load& load, const Options& options, const Tables& tables);
  // With the model's own options and tables.
  Robot(Model model, const arm::Load& load)
      : Robot(model, load, default_options(model), default_tables(model)) {}

  Model model() const { return model_; }
  const arm::Load& load() const { return load_; }
  const Options& options() const { return options_; }
  const Tables& tables() const { return tables_; }

  bool operator==(const Robot& other) const {
    return model_ == other.model_ && load_ == other.load_ && options_ == other.options_ &&
           tables_ == other.tables_;
  }

  int n_axes() const { return robot::n_axes(model_); }
  // Friction everywhere, elasticity and backlash on axes 1 to 3.
  bool has_real_gears() const { return robot::has_real_gears(model_); }
  int n_elastic() const { return robot::n_elastic(model_); }
  bool has_controller() const { return options_.controller != Controller::none; }
  // The elements of axes that users see.
  std::vector<ElementKind> elements() const;
  // p.
  const drive::Row& gear_ratio() const { return tables_.gear_ratio(); }
  // +1 if the branch of an axis' friction tells how its rotor slides; otherwise it tells how its
  // joint slides, and this is the sign of p.
  int friction_side(int axis) const;
  // Whether the rotor of an elastic gear is carried by the arms, coupling "full".
  bool carries_elastic_rotor(int axis) const {
    return axis < n_elastic() && options_.coupling[axis] == Coupling::full;
  }

  // In the order of the state vector.
  const std::vector<StateGroup>& states() const { return states_; }
  int n_states() const;
  // Where a group begins; n_states() if the robot has no such states.
  int first_state(std::string_view name) const;
  // Those that Table 4 counts.
  const std::vector<IndicatorGroup>& indicators() const { return indicators_; }
  int n_indicators() const;

  // The arm with ideal gears: rotors count with all terms if their coupling is "full", with p^2 rJ
  // on the diagonal if it is "simplified".
  using AnyMechanism = std::variant<arm::Mechanism<1>, arm::Mechanism<3>, arm::Mechanism<6>>;
  const AnyMechanism& arm() const { return arm_; }
  // The arm as the models' equations see it: rotors behind elastic gears are separate.
  const AnyMechanism& arm_behind_gears() const { return arm_behind_gears_; }

  // What its runs leave to each other; nothing that can be seen from outside.
  LinearBlocks& linear_blocks() const { return *linear_blocks_; }

 private:
  void name_states();
  void name_indicators();

  Model model_;
  arm::Load load_;
  Options options_;
  Tables tables_;
  std::vector<StateGroup> states_;
  std::vector<IndicatorGroup> indicators_;
  AnyMechanism arm_, arm_behind_gears_;
  std::shared_ptr<LinearBlocks> linear_blocks_ = std::make_shared<LinearBlocks>();
};

// Refuses a motion that the robot cannot follow: as many axes as the robot has; with 3 axes also a
// motion of 6 if axes 4 to 6 stay exactly at zero, where the brakes hold them.
void check_motion(const Robot& robot, const motion::Motion& motion);

}  // namespace manutec_r3::robot
