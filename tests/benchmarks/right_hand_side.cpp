// What one evaluation of the equations costs.
//
//   right_hand_side               all cases: lines "name value unit", nanoseconds of processor time
//                                 per evaluation, the best of many repeats
//   right_hand_side NAME COUNT    evaluates one case so many times and says nothing. The difference
//                                 of two counts, under `valgrind --tool=callgrind`, is the number
//                                 of instructions per evaluation: it repeats exactly.
//
// Every evaluation sees another state than the one before.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <functional>
#include <limits>
#include <memory>
#include <numbers>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "arm/composite.hpp"
#include "motion/motion.hpp"
#include "robot/robot.hpp"
#include "robot/robot_system.hpp"

using namespace manutec_r3;

namespace {

constexpr unsigned n_states_seen = 64;
constexpr int n_evaluations = 20'000;
constexpr int n_repeats = 50;

// Numbers from -1 to 1 that look random and are the same in every run: multiples of the golden
// ratio, their fractions.
class Numbers {
 public:
  double next() {
    fraction_ += std::numbers::phi - 1.0;
    if (fraction_ >= 1.0) fraction_ -= 1.0;
    return 2.0 * fraction_ - 1.0;
  }

 private:
  double fraction_ = 0.5;
};

struct Case {
  std::string name;
  // Evaluates so many times and gives the sum of some results, so that no work is left out.
  std::function<double(int)> run;
};

// --- the right-hand side of a model --------------------------------------------------------------

// A model with all defaults that follows a motion and moves on all axes; or some axes stick.
Case right_hand_side(const std::string& name, robot::Model model,
                     const std::vector<int>& sticking = {}) {
  const auto robot = std::make_shared<const robot::Robot>(model, robot::default_load(model));
  const std::array<double, 6> start = {}, end = {1.0, 1.0, 0.6, -0.2, -0.15, -0.1};  // [rad]
  const std::size_t n = robot->n_axes();
  const auto motion = std::make_shared<const motion::Motion>(
      motion::quintic(std::span(start).first(n), std::span(end).first(n), 1.2));
  const std::shared_ptr<robot::RobotSystem> system = robot::make_system(robot, {.motion = motion});

  Numbers numbers;
  std::vector<std::vector<double>> states(n_states_seen);
  for (std::vector<double>& x : states) {
    for (const robot::StateGroup& group : robot->states()) {
      for (const double nominal : group.nominals) x.push_back(nominal * numbers.next());
    }
  }
  system->initialise(0.3, states.front().data());
  hybrid::Mode mode = system->mode();
  for (const int axis : sticking) mode.branches[robot::friction * n + axis - 1] = 0;
  system->set_mode(mode);
  return {name, [system, states, dx = std::vector<double>(robot->n_states())](int count) mutable {
            double sum = 0.0;
            for (unsigned k = 0; k < static_cast<unsigned>(count); ++k) {
              system->derivatives(0.3, states[k % n_states_seen].data(), dx.data());
              sum += dx.front() + dx.back();
            }
            return sum;
          }};
}

// --- the arm alone -------------------------------------------------------------------------------

// Joint accelerations of N arms with ideal gears under given joint torques.
template <int N>
Case forward_dynamics(const std::string& name, robot::Model model) {
  struct Pose {
    arm::Vector<N> q, qd, tau;
  };
  Numbers numbers;
  std::vector<Pose> poses(n_states_seen);
  for (Pose& pose : poses) {
    for (double& angle : pose.q) angle = 3.0 * numbers.next();
    for (double& rate : pose.qd) rate = 3.0 * numbers.next();
    for (double& torque : pose.tau) torque = 500.0 * numbers.next();
  }
  const robot::Robot robot(model, robot::default_load(model));
  return {name, [poses, mechanism = std::get<arm::Mechanism<N>>(robot.arm())](int count) {
            double sum = 0.0;
            for (unsigned k = 0; k < static_cast<unsigned>(count); ++k) {
              const auto& [q, qd, tau] = poses[k % n_states_seen];
              sum += arm::forward_dynamics<N>(mechanism, q, qd, tau)[0];
            }
            return sum;
          }};
}

std::vector<Case> cases() {
  using robot::Model;
  return {right_hand_side("model_1", Model::dlr_1),
          right_hand_side("model_2", Model::dlr_2),
          right_hand_side("model_3", Model::dlr_3),
          right_hand_side("model_3_wrist_sticks", Model::dlr_3, {4, 5, 6}),
          right_hand_side("model_4", Model::dlr_4),
          right_hand_side("full_robot", Model::full_robot),
          right_hand_side("one_axis", Model::one_axis),
          forward_dynamics<6>("forward_dynamics_of_six_arms", Model::dlr_1),
          forward_dynamics<3>("forward_dynamics_of_three_arms", Model::dlr_2)};
}

// --- measuring -----------------------------------------------------------------------------------

// Refuses results that are no numbers: nothing would have been measured.
void run(Case& measured, int count) {
  if (std::isfinite(measured.run(count))) return;
  std::fprintf(stderr, "%s: not finite\n", measured.name.c_str());
  std::exit(EXIT_FAILURE);
}

double nanoseconds(Case& measured) {
  double best = std::numeric_limits<double>::infinity();
  for (int repeat = 0; repeat < n_repeats; ++repeat) {
    const std::clock_t begin = std::clock();
    run(measured, n_evaluations);
    const double seconds = static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
    best = std::min(best, seconds / n_evaluations);
  }
  return 1e9 * best;
}

}  // namespace

int main(int argc, char** argv) {
  std::vector<Case> all = cases();
  if (argc == 1) {
    for (Case& each : all) std::printf("%s %.1f ns\n", each.name.c_str(), nanoseconds(each));
    return EXIT_SUCCESS;
  }
  const auto named = std::ranges::find(all, std::string_view(argv[1]), &Case::name);
  const int count = argc == 3 ? std::atoi(argv[2]) : 0;
  if (named == all.end() || count <= 0) {
    std::fprintf(stderr, "usage: right_hand_side [NAME COUNT], where NAME is one of");
    for (const Case& each : all) std::fprintf(stderr, " %s", each.name.c_str());
    std::fprintf(stderr, "\n");
    return EXIT_FAILURE;
  }
  run(*named, count);
  return EXIT_SUCCESS;
}
