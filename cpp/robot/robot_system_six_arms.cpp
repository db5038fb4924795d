// Models 1 and 3.
#include "robot/robot_system_of.hpp"

namespace manutec_r3::robot {

template class RobotSystemOf<6, drive::Axes<6>>;

}  // namespace manutec_r3::robot
