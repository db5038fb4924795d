// OneAxis, the Modelica variant.
#include "robot/robot_system_of.hpp"

namespace manutec_r3::robot {

template class RobotSystemOf<1, drive::ModelicaAxes<1>>;

}  // namespace manutec_r3::robot
