// Models 2 and 4.
#include "robot/robot_system_of.hpp"

namespace manutec_r3::robot {

template class RobotSystemOf<3, drive::Axes<3>>;

}  // namespace manutec_r3::robot
