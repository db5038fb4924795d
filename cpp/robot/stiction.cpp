#include "robot/stiction.hpp"

#include <Eigen/LU>
#include <array>
#include <cmath>
#include <utility>

#include "hybrid/failure.hpp"

namespace manutec_r3::robot {
namespace {

// In the order of the rule's last tie-break.
constexpr std::array<int, 3> choices = {0, -1, +1};

// An axis that has reached its limit starts with an acceleration that may be zero: relative to what
// friction can do, this is zero.
constexpr double roundoff = 1e-9;

bool consistent(const RestingAxes& axes, const std::vector<int>& branches, bool release) {
  const int n = static_cast<int>(branches.size());
  Eigen::VectorXd friction = Eigen::VectorXd::Zero(n);  // p r, joint side
  std::vector<int> sticking;
  for (int i = 0; i < n; ++i) {
    friction[i] = axes.p[i] * branches[i] * axes.rM_1[i];
    if (branches[i] != 0) continue;
    if (release && axes.released[i]) return false;
    sticking.push_back(i);
  }
  if (!sticking.empty()) {
    const Eigen::VectorXd acceleration = axes.a0 - axes.W * friction;  // if nothing held them
    const Eigen::VectorXd holding =
        axes.W(sticking, sticking).lu().solve(acceleration(sticking).eval());
    friction(sticking) = holding;
    for (const int i : sticking) {
      // Not at the limit that it has just reached: that is what it must leave.
      const double limit = axes.rM_h[i] * (axes.released[i] ? 1.0 - roundoff : 1.0);
      if (std::abs(friction[i] / axes.p[i]) > limit) return false;
    }
  }
  const Eigen::VectorXd acceleration = axes.a0 - axes.W * friction;
  for (int i = 0; i < n; ++i) {
    if (branches[i] == 0) continue;
    const double least = axes.released[i] ? -roundoff * axes.W(i, i) * axes.rM_h[i] : 0.0;
    if (!(branches[i] * acceleration[i] / axes.p[i] > least)) return false;
  }
  return true;
}

std::vector<int> best_branches(const RestingAxes& axes, bool release) {
  const int n = static_cast<int>(axes.p.size());
  int combinations = 1;
  for (int i = 0; i < n; ++i) combinations *= 3;

  std::vector<int> best;
  std::pair<int, int> best_rank = {-1, -1};
  std::vector<int> branches(n);
  for (int combination = 0; combination < combinations; ++combination) {
    std::pair<int, int> rank = {0, 0};  // sticking axes, those among them that stick already
    int rest = combination;
    for (int i = n - 1; i >= 0; --i, rest /= 3) {
      branches[i] = choices[rest % 3];
      rank.first += branches[i] == 0;
      rank.second += branches[i] == 0 && axes.sticks[i];
    }
    if (rank > best_rank && consistent(axes, branches, release)) {
      best = branches;
      best_rank = rank;
    }
  }
  return best;
}

}  // namespace

std::vector<int> consistent_branches(const RestingAxes& axes) {
  std::vector<int> branches = best_branches(axes, true);
  // Rarely others must slide in its place.
  if (branches.empty()) branches = best_branches(axes, false);
  if (branches.empty()) {
    throw hybrid::SimulationFailure(
        "no combination of sticking and sliding axes agrees with physics");
  }
  return branches;
}

}  // namespace manutec_r3::robot
