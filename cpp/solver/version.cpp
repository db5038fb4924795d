#include "solver/version.hpp"

#include <sundials/sundials_version.h>

#include <array>

namespace manutec_r3::solver {

std::string sundials_version() {
  std::array<char, 32> text{};
  SUNDIALSGetVersion(text.data(), static_cast<int>(text.size()));
  return text.data();
}

}  // namespace manutec_r3::solver
