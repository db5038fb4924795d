// The robots as linear blocks (robot/linear_drives.hpp): the same equations, read another way.
#include "hybrid/linear_view.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <random>
#include <span>
#include <vector>

#include "check.hpp"
#include "motion/motion.hpp"
#include "robot/robot.hpp"
#include "robot/robot_system.hpp"

namespace manutec_r3::testing {
namespace {

using numbers::Abreast;
using robot::Controller;
using robot::Model;

struct Case {
  Model model;
  robot::Options options;
};

// Every model, with options that change its equations.
std::vector<Case> cases() {
  std::vector<Case> cases;
  for (const Model model : {Model::dlr_1, Model::dlr_2, Model::dlr_3, Model::dlr_4,
                            Model::full_robot, Model::one_axis}) {
    const robot::Options plain = robot::default_options(model);
    cases.push_back({model, plain});
    if (robot::is_modelica(model)) continue;
    for (const Controller controller :
         {Controller::sampled, Controller::external, Controller::none}) {
      cases.push_back({model, plain});
      cases.back().options.controller = controller;
    }
    cases.push_back({model, plain});
    cases.back().options.voltage_limit = 0.7;
    cases.push_back({model, plain});
    cases.back().options.coupling.fill(robot::Coupling::full);
    if (!robot::has_real_gears(model)) continue;
    cases.push_back({model, cases.back().options});
    cases.back().options.gear_damping = drive::GearDamping::contact;
  }
  return cases;
}

std::unique_ptr<robot::RobotSystem> system_of(const Case& one) {
  const int n = robot::n_axes(one.model);
  const std::vector<double> start(n, 0.1), end(n, -0.4);
  const arm::Load load =
      robot::is_modelica(one.model) ? robot::default_load(one.model) : arm::Load{.mass = 7.0};
  const auto robot = std::make_shared<const robot::Robot>(one.model, load, one.options,
                                                          robot::default_tables(one.model));
  const auto motion = std::make_shared<const motion::Motion>(motion::quintic(start, end, 1.0));
  return robot::make_system(robot, {.motion = motion});
}

// A state of the size of its nominal values, some axes at rest, in the branches that belong to it.
std::vector<double> decided_state(robot::RobotSystem& system, std::mt19937& random, double t) {
  std::uniform_real_distribution<double> uniform(-2.0, 2.0);
  std::vector<double> x(system.n_states());
  for (std::size_t s = 0; s < x.size(); ++s) x[s] = uniform(random) * system.nominals()[s];
  for (int i = 0; i < system.n_axes(); ++i) {
    if (uniform(random) > 0.7) x[system.n_axes() + i] = 0.0;
  }
  system.initialise(t, x.data());
  return x;
}

struct Inputs {
  std::vector<double> constants, forcing, remainder;

  Inputs(hybrid::LinearView& view, double t, const double* x) {
    int n_constants = 0, n_forcing = 0, n_remainder = 0;
    for (int b = 0; b < view.n_blocks(); ++b) {
      n_constants += view.block(b).n_constants;
      n_forcing += view.block(b).n_forcing;
      n_remainder += view.block(b).n_remainder;
    }
    constants.resize(n_constants);
    forcing.resize(n_forcing);
    remainder.resize(n_remainder);
    view.constants(constants.data());
    view.forcing(t, forcing.data());
    view.remainder(t, x, remainder.data());
  }
};

// L x + B u of all blocks.
std::vector<double> by_blocks(hybrid::LinearView& view, const std::vector<double>& x,
                              const Inputs& inputs) {
  std::vector<double> dx(x.size(), std::nan(""));
  auto constant = inputs.constants.begin(), forcing = inputs.forcing.begin(),
       remainder = inputs.remainder.begin();
  for (int b = 0; b < view.n_blocks(); ++b) {
    const hybrid::LinearBlock& block = view.block(b);
    Eigen::VectorXd of_block(block.states.size()), u(block.B.cols());
    for (std::size_t k = 0; k < block.states.size(); ++k) of_block[k] = x[block.states[k]];
    for (int i = 0; i < u.size(); ++i) {
      u[i] = i < block.n_constants                     ? *constant++
             : i < block.n_constants + block.n_forcing ? *forcing++
                                                       : *remainder++;
    }
    const Eigen::VectorXd rates = block.L * of_block + block.B * u;
    for (std::size_t k = 0; k < block.states.size(); ++k) dx[block.states[k]] = rates[k];
  }
  return dx;
}

TEST(BlocksAndRemaindersAreTheDerivatives) {
  std::mt19937 random(1);
  for (const Case& one : cases()) {
    const auto system = system_of(one);
    for (int trial = 0; trial < 50; ++trial) {
      const double t = 0.02 * trial;
      const std::vector<double> x = decided_state(*system, random, t);
      hybrid::LinearView& view = *system->linear_view();
      std::vector<double> expected(x.size());
      system->derivatives(t, x.data(), expected.data());
      const std::vector<double> dx = by_blocks(view, x, Inputs(view, t, x.data()));
      for (std::size_t s = 0; s < x.size(); ++s) {
        // Terms of the equations of motors are w^2 = 5e7 times a nominal value; they cancel.
        const double scale = std::abs(expected[s]) + 1e8 * system->nominals()[s];
        CHECK_NEAR(dx[s], expected[s], 1e-15 * scale);
      }
    }
  }
}

TEST(EveryStateIsInOneBlock) {
  for (const Case& one : cases()) {
    const auto system = system_of(one);
    std::vector<int> count(system->n_states(), 0);
    for (int b = 0; b < system->linear_view()->n_blocks(); ++b) {
      for (const int state : system->linear_view()->block(b).states) ++count[state];
    }
    CHECK(std::ranges::all_of(count, [](int n) { return n == 1; }));
  }
}

TEST(RemaindersAndIndicatorsReadWatchedStatesOnly) {
  std::mt19937 random(2);
  for (const Case& one : cases()) {
    const auto system = system_of(one);
    hybrid::LinearView& view = *system->linear_view();
    for (int trial = 0; trial < 20; ++trial) {
      const std::vector<double> x = decided_state(*system, random, 0.3);
      std::vector<double> watched(x.size(), 1e3);  // what is not watched is far off
      for (int b = 0; b < view.n_blocks(); ++b) {
        const hybrid::LinearBlock& block = view.block(b);
        for (const int place : block.watched) watched[block.states[place]] = x[block.states[place]];
      }
      CHECK(Inputs(view, 0.3, x.data()).remainder == Inputs(view, 0.3, watched.data()).remainder);
      std::vector<double> z(system->n_indicators()), z_watched(z.size());
      system->indicators(0.3, x.data(), z.data());
      system->indicators(0.3, watched.data(), z_watched.data());
      CHECK(z == z_watched);
    }
  }
}

TEST(RatesOfIndicatorsAreThoseOfADifference) {
  std::mt19937 random(3);
  for (const Case& one : cases()) {
    const auto system = system_of(one);
    for (int trial = 0; trial < 20; ++trial) {
      const std::vector<double> x = decided_state(*system, random, 0.3);
      std::vector<double> dx(x.size()), rates(system->n_indicators()), expected(rates.size());
      system->derivatives(0.3, x.data(), dx.data());
      system->indicator_rates(0.3, x.data(), dx.data(), rates.data());
      system->hybrid::System::indicator_rates(0.3, x.data(), dx.data(), expected.data());
      for (std::size_t i = 0; i < rates.size(); ++i) {
        // Indicators of order 10 to 300 have roundoff of 3e-14, divided by 1e-7 s; rates of rotors
        // that are thrown about change by a part in 1e4 meanwhile.
        CHECK_NEAR(rates[i], expected[i], 1e-5 + 1e-3 * std::abs(expected[i]));
      }
    }
  }
}

// Of a few vectors, each at one instant, what is abreast.
std::vector<Abreast> abreast(const std::array<std::vector<double>, Abreast::size>& at_instants) {
  std::vector<Abreast> numbers(at_instants[0].size());
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    for (int k = 0; k < Abreast::size; ++k) numbers[i][k] = at_instants[k][i];
  }
  return numbers;
}

// What is true at four instants, in states close to each other on the same branches, is what is
// true at each of them; and what indicators are told by the remainder is what they find.
TEST(FourInstantsAbreastAreFourInstants) {
  std::mt19937 random(4);
  int held = 0;
  for (const Case& one : cases()) {
    const auto system = system_of(one);
    hybrid::LinearView& view = *system->linear_view();
    const int n_z = system->n_indicators();
    for (int trial = 0; trial < 50; ++trial) {
      std::array<std::vector<double>, Abreast::size> x, dx, forcing, u, z, dz;
      std::uniform_real_distribution<double> nearby(1.0, 1.01);
      x[0] = decided_state(*system, random, 0.3);
      for (int i = 0; i < system->n_axes(); ++i) held += system->branch(robot::friction, i) == 0;
      Abreast t;
      for (int k = 0; k < Abreast::size; ++k) {
        t[k] = 0.3 + 0.01 * k;
        x[k] = x[0];
        if (k > 0) {
          for (double& value : x[k]) value *= nearby(random);
        }
        const Inputs inputs(view, t[k], x[k].data());
        forcing[k] = inputs.forcing;
        u[k] = inputs.remainder;
        z[k].resize(n_z);
        system->indicators(t[k], x[k].data(), z[k].data());
        dx[k].resize(x[k].size());
        dz[k].resize(n_z);
        system->derivatives(t[k], x[k].data(), dx[k].data());
        system->indicator_rates(t[k], x[k].data(), dx[k].data(), dz[k].data());
      }
      std::vector<Abreast> forcing_now(forcing[0].size()), u_now(u[0].size()), z_now(n_z),
          dz_now(n_z);
      const std::vector<Abreast> x_now = abreast(x), dx_now = abreast(dx);
      view.forcing(t, forcing_now.data());
      view.remainder(t, x_now.data(), u_now.data());
      view.indicators(t, x_now.data(), u_now.data(), z_now.data());
      // Remainders change as fast as a difference says.
      std::vector<Abreast> u_soon(u_now), x_soon(x_now), du(u_now.size());
      constexpr double soon = 1e-7;
      for (std::size_t s = 0; s < x_soon.size(); ++s) x_soon[s] += soon * dx_now[s];
      view.remainder(t + soon, x_soon.data(), u_soon.data());
      for (std::size_t i = 0; i < du.size(); ++i) du[i] = (u_soon[i] - u_now[i]) / soon;
      view.indicator_rates(t, x_now.data(), dx_now.data(), u_now.data(), du.data(), dz_now.data());
      for (int k = 0; k < Abreast::size; ++k) {
        // Sums in another order: roundoff of terms of their size, in a system of equations.
        for (std::size_t i = 0; i < forcing_now.size(); ++i) {
          CHECK_NEAR(forcing_now[i][k], forcing[k][i], 1e-15 * (1.0 + std::abs(forcing[k][i])));
        }
        for (std::size_t i = 0; i < u_now.size(); ++i) {
          CHECK_NEAR(u_now[i][k], u[k][i], 1e-11 * (1.0 + std::abs(u[k][i])));
        }
        for (int i = 0; i < n_z; ++i) {
          CHECK_NEAR(z_now[i][k], z[k][i], 1e-11 * (1.0 + std::abs(z[k][i])));
          CHECK_NEAR(dz_now[i][k], dz[k][i], 1e-4 + 1e-3 * std::abs(dz[k][i]));
        }
      }
    }
  }
  CHECK(held > 100);
}

TEST(StiffStickingHasNoSlowRemainder) {
  for (const robot::Stiction stiction :
       {robot::Stiction::stiff_spring, robot::Stiction::stiff_damper}) {
    Case one{Model::dlr_3, robot::default_options(Model::dlr_3)};
    one.options.stiction = stiction;
    CHECK(system_of(one)->linear_view() == nullptr);
  }
}

}  // namespace
}  // namespace manutec_r3::testing
