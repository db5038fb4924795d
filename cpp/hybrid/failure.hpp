// A run cannot go on. Thrown by integrators, by systems and by the simulation itself; the message
// is the reason. The simulation stays where it got to.
#pragma once

#include <stdexcept>

namespace manutec_r3::hybrid {

class SimulationFailure : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace manutec_r3::hybrid
