// FullRobot, the Modelica variant.
#include "robot/robot_system_of.hpp"

namespace manutec_r3::robot {

template class RobotSystemOf<6, drive::ModelicaAxes<6>>;

}  // namespace manutec_r3::robot
