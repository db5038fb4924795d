// Ends a run that would switch for ever (event semantics 6, see simulation.hpp).
#pragma once

#include <cstddef>
#include <map>
#include <vector>

#include "hybrid/system.hpp"

namespace manutec_r3::hybrid {

// Counts the events of each element.
class ChatteringGuard {
 public:
  // Whether this event of an element is one too many.
  bool exceeded(Element element, double t);

  struct History {
    int at_this_instant = 0;
    std::vector<double> recent;  // instants, a ring
    std::size_t oldest = 0;
  };
  // All that it knows, to be saved.
  std::map<Element, History>& histories() { return histories_; }
  const std::map<Element, History>& histories() const { return histories_; }

 private:
  std::map<Element, History> histories_;
};

}  // namespace manutec_r3::hybrid
