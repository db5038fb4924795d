// How the combination of spec 5.3 is found. On the motor side, with u = p a,
//
//   u = u0 - V r,   V = p W p.
//
// Whatever friction is within its limits, an axis with |u0_i| > sum_j |V_ij| rM_h_j slides, in the
// direction of u0_i. All other axes are held, and then released one by one. An axis that is held
// with the torque r can begin to slide if |r| > rM_1, in the direction of r, provided that no other
// one that has been released turns round.
//
// All combinations T of released axes that accelerate in the direction that their friction opposes
// are reached in this way: with K = V_TT (the others held), hold the axis i of T with the least
// |u_i| / sqrt(K_ii). Then u_j of the others becomes
//
//   u_j - K_ji / K_ii u_i,   and |K_ji / K_ii u_i| < sqrt(K_jj / K_ii) |u_i| <= |u_j|:
//
// they slide on, and i is what can be released next. So the combinations with 1, 2, ... released
// axes follow from each other, no direction has to be guessed, and the rule's is among the first
// that keep the sticking axes within their limits.
#include "robot/stiction.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <ranges>
#include <utility>

#include "hybrid/failure.hpp"

namespace manutec_r3::robot {
namespace {

// An axis that has reached its limit starts with an acceleration that may be zero: relative to its
// friction, this is zero.
constexpr double roundoff = 1e-9;

using Branches = std::array<int, 6>;

struct Combination {
  Branches branches;
  // Of an axis that is held u = 0 is given and r follows, of the others r is given and u follows.
  RestingVector follows;
  RestingMatrix V;  // what is given changes what follows by -V times its own change

  // Of axis i, what followed is given from now on.
  void give(int i, double given) {
    const double pivot = V(i, i);
    const RestingVector column = V.col(i) / pivot;
    const RestingVector row = V.row(i);
    const double change = follows[i] - given;
    follows -= column * change;
    follows[i] = change / pivot;
    V.noalias() -= column * row.transpose();
    V.row(i) = row.transpose() / pivot;
    V.col(i) = -column;
    V(i, i) = 1.0 / pivot;
  }
};

class Search {
 public:
  explicit Search(const RestingAxes& axes)
      : axes_(axes), n_(static_cast<int>(axes.p.size())), rM_h_(axes.rM_h), rM_1_(axes.rM_1) {
    for (int i = 0; i < n_; ++i) {
      if (!axes.released[i]) continue;
      // Not at the limit that it has just reached: that is what it must leave.
      rM_h_[i] *= 1.0 - roundoff;
      rM_1_[i] *= 1.0 - roundoff;
    }
    held_ = hold_what_friction_can_hold();
  }

  // The one of the rule, if there is one, with or without regard to what must slide.
  std::optional<Branches> preferred(bool release) const {
    for (std::vector<Combination> level = {held_}; !level.empty();
         level = release_one_more(level)) {
      auto consistent = level | std::views::filter([&](const Combination& combination) {
                          return sticks_within_limits(combination, release);
                        });
      const auto best = std::ranges::min_element(
          consistent, {}, [&](const Combination& combination) { return rank(combination); });
      if (best != consistent.end()) return best->branches;
    }
    return std::nullopt;
  }

 private:
  bool is_brake(int i) const { return std::isinf(rM_h_[i]); }

  Combination hold_what_friction_can_hold() const {
    Combination held = {
        {}, axes_.p.cwiseProduct(axes_.a0), axes_.p.asDiagonal() * axes_.W * axes_.p.asDiagonal()};
    std::vector<int> open;
    for (int i = 0; i < n_; ++i) {
      if (is_brake(i)) {
        held.give(i, 0.0);
      } else {
        open.push_back(i);
      }
    }
    const auto slides = [&](int i) {
      double strongest = 0.0;
      for (const int j : open) strongest += std::abs(held.V(i, j)) * rM_h_[j];
      return std::abs(held.follows[i]) > strongest;
    };
    for (auto i = open.begin(); (i = std::ranges::find_if(open, slides)) != open.end();) {
      held.branches[*i] = held.follows[*i] < 0.0 ? -1 : +1;
      held.follows -= held.V.col(*i) * held.branches[*i] * rM_1_[*i];
      open.erase(i);
    }
    for (const int i : open) held.give(i, 0.0);
    return held;
  }

  std::vector<Combination> release_one_more(const std::vector<Combination>& level) const {
    std::vector<Combination> found;
    for (const Combination& combination : level) {
      for (int i = 0; i < n_; ++i) {
        const double r = combination.follows[i];
        if (combination.branches[i] != 0 || is_brake(i) || !(std::abs(r) > rM_1_[i])) continue;
        Branches branches = combination.branches;
        branches[i] = r < 0.0 ? -1 : +1;
        if (std::ranges::find(found, branches, &Combination::branches) != found.end()) continue;
        Combination released = combination;
        released.branches = branches;
        released.give(i, branches[i] * rM_1_[i]);
        if (none_turns_round(released)) found.push_back(released);
      }
    }
    return found;
  }

  // Apart from those that no friction can hold: nothing within its limits turns these.
  bool none_turns_round(const Combination& combination) const {
    for (int i = 0; i < n_; ++i) {
      const bool was_released = combination.branches[i] != held_.branches[i];
      if (was_released && !(combination.branches[i] * combination.follows[i] > 0.0)) return false;
    }
    return true;
  }

  bool sticks_within_limits(const Combination& combination, bool release) const {
    for (int i = 0; i < n_; ++i) {
      if (combination.branches[i] != 0) continue;
      if (release && axes_.released[i]) return false;
      if (!(std::abs(combination.follows[i]) <= rM_h_[i])) return false;
    }
    return true;
  }

  // What the rule prefers among combinations with as many sticking axes comes first.
  std::pair<int, Branches> rank(const Combination& combination) const {
    int begin_to_slide = 0;
    Branches order;
    for (int i = 0; i < n_; ++i) begin_to_slide += combination.branches[i] != 0 && axes_.sticks[i];
    std::ranges::transform(combination.branches, order.begin(),
                           [](int branch) { return branch > 0 ? 2 : -branch; });
    return {begin_to_slide, order};
  }

  const RestingAxes& axes_;
  int n_;
  RestingVector rM_h_, rM_1_;
  Combination held_;
};

}  // namespace

std::vector<int> consistent_branches(const RestingAxes& axes) {
  const Search search(axes);
  // Rarely others must slide in place of what should be released.
  for (const bool release : {true, false}) {
    if (const auto branches = search.preferred(release)) {
      return {branches->begin(), branches->begin() + axes.p.size()};
    }
  }
  throw hybrid::SimulationFailure(
      "no combination of sticking and sliding axes agrees with physics");
}

}  // namespace manutec_r3::robot
