#include "robot/robot_system.hpp"

#include <utility>

#include "drive/axis.hpp"
#include "drive/modelica_axis.hpp"
#include "robot/robot_system_of.hpp"

namespace manutec_r3::robot {

// Each in a file of its own, robot_system_*.cpp: they take long to compile.
extern template class RobotSystemOf<3, drive::Axes<3>>;
extern template class RobotSystemOf<6, drive::Axes<6>>;
extern template class RobotSystemOf<1, drive::ModelicaAxes<1>>;
extern template class RobotSystemOf<6, drive::ModelicaAxes<6>>;

namespace {

template <int N, class Axes, class Table>
std::unique_ptr<RobotSystem> system_of(std::shared_ptr<const Robot> robot, Inputs inputs) {
  const Axes axes(std::get<Table>(robot->tables().table_1));
  return std::make_unique<RobotSystemOf<N, Axes>>(std::move(robot), axes, std::move(inputs));
}

}  // namespace

std::unique_ptr<RobotSystem> make_system(std::shared_ptr<const Robot> robot, Inputs inputs) {
  using drive::Axes, drive::ModelicaAxes, drive::ModelicaTable1, drive::Table1;
  const int n = robot->n_axes();
  if (n == 1) return system_of<1, ModelicaAxes<1>, ModelicaTable1>(std::move(robot), inputs);
  if (n == 3) return system_of<3, Axes<3>, Table1>(std::move(robot), inputs);
  if (is_modelica(robot->model())) {
    return system_of<6, ModelicaAxes<6>, ModelicaTable1>(std::move(robot), inputs);
  }
  return system_of<6, Axes<6>, Table1>(std::move(robot), inputs);
}

}  // namespace manutec_r3::robot
