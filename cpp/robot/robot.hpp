// One of the four DLR models with its load: what is simulated, immutable (spec 7; report Table 4).
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "arm/load.hpp"
#include "arm/mechanism.hpp"
#include "drive/parameters.hpp"
#include "motion/motion.hpp"

namespace manutec_r3::robot {

enum class Controller {
  continuous,  // the position loop is evaluated at every instant
  none,        // no controller, no motor dynamics: motor torques are inputs
};

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
  // Throws std::invalid_argument: model is 1 to 4, the load within its bounds.
  Robot(int model, const arm::Load& load, Controller controller);

  int model() const { return model_; }
  const arm::Load& load() const { return load_; }
  Controller controller() const { return controller_; }
  bool operator==(const Robot& other) const {
    return model_ == other.model_ && load_ == other.load_ && controller_ == other.controller_;
  }

  int n_axes() const { return model_ == 1 || model_ == 3 ? 6 : 3; }
  // Friction everywhere, elasticity and backlash on axes 1 to 3.
  bool has_real_gears() const { return model_ >= 3; }
  int n_elastic() const { return has_real_gears() ? drive::n_elastic : 0; }
  bool has_controller() const { return controller_ != Controller::none; }

  // In the order of the state vector.
  const std::vector<StateGroup>& states() const { return states_; }
  int n_states() const;
  // Where a group begins; n_states() if the robot has no such states.
  int first_state(std::string_view name) const;
  // Those that Table 4 counts.
  const std::vector<IndicatorGroup>& indicators() const { return indicators_; }
  int n_indicators() const;

  // The arm with ideal gears: rotors of axes with elastic gears (coupling "simplified") count
  // with p^2 rJ on the diagonal, the others with full coupling.
  using AnyMechanism = std::variant<arm::Mechanism<3>, arm::Mechanism<6>>;
  const AnyMechanism& arm() const { return arm_; }
  // The arm as the models' equations see it: rotors behind elastic gears are separate.
  const AnyMechanism& arm_behind_gears() const { return arm_behind_gears_; }

 private:
  int model_;
  arm::Load load_;
  Controller controller_;
  std::vector<StateGroup> states_;
  std::vector<IndicatorGroup> indicators_;
  AnyMechanism arm_, arm_behind_gears_;
};

// Refuses a motion that the robot cannot follow: 3 or 6 axes as the robot has; with 3 axes a motion
// of 6 if axes 4 to 6 stay exactly at zero, where the brakes hold them.
void check_motion(const Robot& robot, const motion::Motion& motion);

}  // namespace manutec_r3::robot
