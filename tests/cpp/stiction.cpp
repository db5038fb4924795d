// The rule of spec 5.3, against the same rule written down a second time: every combination of
// sticking, sliding backward and sliding forward is solved for as a linear system of all unknown
// accelerations and friction torques, sorted by what the rule prefers.
#include "robot/stiction.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <random>
#include <tuple>
#include <vector>

#include "check.hpp"
#include "hybrid/failure.hpp"

namespace manutec_r3::testing {
namespace {

using robot::RestingAxes;

// M a + p r = F: with sticking axes a is known (0), with sliding ones r is (s rM_1).
bool agrees_with_physics(const RestingAxes& axes, const std::vector<int>& branches) {
  const int n = static_cast<int>(branches.size());
  const Eigen::MatrixXd M = axes.W.inverse();
  Eigen::VectorXd right = M * axes.a0;  // F
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(n, n);
  for (int j = 0; j < n; ++j) {
    if (branches[j] == 0) {
      A(j, j) = axes.p[j];  // unknown r_j
    } else {
      A.col(j) = M.col(j);  // unknown a_j
      right[j] -= axes.p[j] * branches[j] * axes.rM_1[j];
    }
  }
  const Eigen::VectorXd unknown = A.fullPivLu().solve(right);
  for (int j = 0; j < n; ++j) {
    if (branches[j] == 0) {
      if (axes.released[j] || std::abs(unknown[j]) > axes.rM_h[j]) return false;
    } else {
      const double rotor_acceleration = axes.p[j] * unknown[j];
      if (!(branches[j] * rotor_acceleration > 0.0)) return false;
    }
  }
  return true;
}

std::vector<std::vector<int>> consistent_ones(const RestingAxes& axes) {
  const int n = static_cast<int>(axes.p.size());
  std::vector<std::vector<int>> found, all = {{}};
  for (int i = 0; i < n; ++i) {
    std::vector<std::vector<int>> longer;
    for (const auto& branches : all) {
      for (const int branch : {0, -1, +1}) {
        longer.push_back(branches);
        longer.back().push_back(branch);
      }
    }
    all = longer;
  }
  for (const auto& branches : all) {
    if (agrees_with_physics(axes, branches)) found.push_back(branches);
  }
  return found;
}

// Spec 5.3: "the one with most sticking axes; on a tie the one that keeps most of the axes that
// stick already; then the lexicographically first (sticking before -1 before +1, axis 1 first)".
std::vector<int> preferred(const RestingAxes& axes, const std::vector<std::vector<int>>& found) {
  const auto rank = [&axes](const std::vector<int>& branches) {
    int sticking = 0, kept = 0;
    std::vector<int> order;
    for (std::size_t i = 0; i < branches.size(); ++i) {
      sticking += branches[i] == 0;
      kept += branches[i] == 0 && axes.sticks[i];
      order.push_back(branches[i] == 0 ? 0 : branches[i] < 0 ? 1 : 2);
    }
    return std::tuple(-sticking, -kept, order);
  };
  return *std::ranges::min_element(found, {}, rank);
}

class Random {
 public:
  explicit Random(int seed) : generator_(seed) {}

  double between(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(generator_);
  }
  // Axes like those of the wrist: inertias of some units, gear ratios of either sign, coupling from
  // weak to strong, and a load at which about every second axis slides.
  RestingAxes axes(int n, double largest_peak) {
    RestingAxes axes;
    Eigen::MatrixXd B(n, n);
    axes.p.resize(n);
    axes.rM_h.resize(n);
    axes.rM_1.resize(n);
    Eigen::VectorXd load(n);
    for (int i = 0; i < n; ++i) {
      for (int j = 0; j < n; ++j) B(i, j) = between(-1.0, 1.0);
      axes.p[i] = between(50.0, 100.0) * (between(-1.0, 1.0) < 0.0 ? -1.0 : 1.0);
      axes.rM_1[i] = between(0.1, 0.5);
      axes.rM_h[i] = axes.rM_1[i] * (1.0 + between(0.0, largest_peak));
      load[i] = axes.p[i] * axes.rM_h[i] * between(-1.7, 1.7);
      axes.sticks.push_back(between(0.0, 1.0) < 0.5);
      axes.released.push_back(false);
    }
    const Eigen::MatrixXd M = B * B.transpose() + 0.05 * Eigen::MatrixXd::Identity(n, n);
    axes.W = M.inverse();
    axes.a0 = axes.W * load;
    return axes;
  }

 private:
  std::mt19937 generator_;
};

TEST(TheBranchesAreThoseOfTheRule) {
  for (int n = 1; n <= 3; ++n) {
    Random random(n);
    int several = 0;
    for (int k = 0; k < 3000; ++k) {
      const RestingAxes axes = random.axes(n, 1.0);
      const std::vector<std::vector<int>> found = consistent_ones(axes);
      CHECK(!found.empty());
      several += found.size() > 1;
      CHECK(robot::consistent_branches(axes) == preferred(axes, found));
    }
    CHECK(several > 100);  // otherwise the rule would not have been tested
  }
}

TEST(TheBranchesAreUniqueWithoutAStaticPeak) {
  for (int n = 1; n <= 3; ++n) {
    Random random(100 + n);
    for (int k = 0; k < 1000; ++k) {
      const RestingAxes axes = random.axes(n, 0.0);
      const std::vector<std::vector<int>> found = consistent_ones(axes);
      CHECK_EQUAL(found.size(), 1u);
      CHECK(robot::consistent_branches(axes) == found.front());
    }
  }
}

TEST(OnATieThoseThatStickAlreadyGoOnSticking) {
  // Found among random cases: such ties are rare.
  Random random(9);
  int ties = 0;
  for (int k = 0; k < 20000 && ties < 5; ++k) {
    RestingAxes axes = random.axes(3, 2.0);
    const std::vector<std::vector<int>> found = consistent_ones(axes);
    std::ptrdiff_t most = 0;
    for (const auto& branches : found) most = std::max(most, std::ranges::count(branches, 0));
    std::vector<std::vector<int>> best;
    for (const auto& branches : found) {
      if (std::ranges::count(branches, 0) == most) best.push_back(branches);
    }
    if (best.size() < 2) continue;
    ++ties;
    for (const auto& wanted : best) {
      for (int i = 0; i < 3; ++i) axes.sticks[i] = wanted[i] == 0;
      CHECK(robot::consistent_branches(axes) == preferred(axes, found));
    }
  }
  CHECK(ties > 0);
}

TEST(AnAxisAtItsLimitIsReleasedInTheDirectionThatPushesIt) {
  // One axis: driven by its limit exactly, it slides although sticking would agree with physics.
  for (const double p : {60.0, -99.0}) {
    for (const int direction : {-1, +1}) {
      for (const double rM_1 : {0.22, 0.27}) {  // with and without a static peak
        RestingAxes axes;
        axes.W = Eigen::MatrixXd::Constant(1, 1, 0.5);
        axes.p = Eigen::VectorXd::Constant(1, p);
        axes.rM_h = Eigen::VectorXd::Constant(1, 0.27);
        axes.rM_1 = Eigen::VectorXd::Constant(1, rM_1);
        axes.a0 = axes.W * axes.p * axes.rM_h[0] * direction;
        axes.sticks = {true};
        axes.released = {false};
        // An ulp within the limit, which roundoff could put beyond it.
        RestingAxes within = axes;
        within.a0 *= 1.0 - 1e-15;
        CHECK(robot::consistent_branches(within) == std::vector<int>{0});
        axes.released = {true};
        CHECK(robot::consistent_branches(axes) == std::vector<int>{direction});
      }
    }
  }
}

TEST(ThereIsAlwaysAWayOnForAnAxisAtItsLimit) {
  // All axes stick, and one of them has just reached its limit: it slides, by the rule. Now and
  // then (strong coupling, high peaks) no combination in which it slides agrees with physics: then
  // others slide and it sticks, within its limit.
  int sticks_on = 0;
  for (int n = 2; n <= 3; ++n) {
    Random random(200 + n);
    for (int k = 0; k < 20000; ++k) {
      RestingAxes axes = random.axes(n, 1.5);
      const Eigen::VectorXd holding =
          (axes.W.inverse() * axes.a0).array() / axes.p.array() / axes.rM_h.array();
      int first = 0;
      axes.a0 /= holding.cwiseAbs().maxCoeff(&first);
      axes.sticks.assign(n, true);
      axes.released[first] = true;
      const std::vector<std::vector<int>> found = consistent_ones(axes);
      if (!found.empty()) {
        CHECK(robot::consistent_branches(axes) == preferred(axes, found));
        continue;
      }
      ++sticks_on;
      // What follows from the axis being a little beyond its limit.
      RestingAxes beyond = axes;
      beyond.a0 *= 1.0 + 1e-7;
      beyond.released[first] = false;
      const std::vector<std::vector<int>> others = consistent_ones(beyond);
      CHECK(!others.empty());
      std::vector<int> branches;
      try {
        branches = robot::consistent_branches(axes);
      } catch (const hybrid::SimulationFailure& failure) {
        CHECK_EQUAL(failure.what(), std::string("a combination"));
        continue;
      }
      CHECK(branches == preferred(beyond, others));
      CHECK_EQUAL(branches[first], 0);
    }
  }
  CHECK(sticks_on > 0);
}

}  // namespace
}  // namespace manutec_r3::testing
