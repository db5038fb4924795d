// Which SUNDIALS integrates.
#pragma once

#include <string>

namespace manutec_r3::solver {

// Such as "7.9.0".
std::string sundials_version();

}  // namespace manutec_r3::solver
