#include "hybrid/chattering.hpp"

#include "hybrid/crossing.hpp"

namespace manutec_r3::hybrid {
namespace {

constexpr int most_events_at_one_instant = 100;
constexpr std::size_t most_events_in_short_time = 1000;
constexpr double short_time = 1e-3;  // [s]

}  // namespace

bool ChatteringGuard::exceeded(Element element, double t) {
  History& history = histories_[element];
  std::vector<double>& recent = history.recent;
  const bool first = recent.empty();
  const std::size_t size = recent.size();
  const double latest = first ? 0.0 : recent[(history.oldest + size - 1) % size];
  const bool same_instant = !first && t - latest <= simultaneous(t);
  history.at_this_instant = same_instant ? history.at_this_instant + 1 : 1;
  bool many_in_short_time = false;
  if (size < most_events_in_short_time) {
    recent.push_back(t);
  } else {
    many_in_short_time = t - recent[history.oldest] <= short_time;
    recent[history.oldest] = t;
    history.oldest = (history.oldest + 1) % size;
  }
  return history.at_this_instant > most_events_at_one_instant || many_in_short_time;
}

}  // namespace manutec_r3::hybrid
