// Arms of the Modelica variant: its frames have y upwards; x, y, z there are x, z, -y here.
// Sources: the specification of the variant, which takes the numbers from the Modelica Standard
// Library.
#include "robot/tables.hpp"

#include <algorithm>

namespace manutec_r3::robot {
namespace {

// Diagonal elements of tensors that are not given are this [kg m^2].
constexpr double small = 0.001;

arm::Table3 full_robot_table_3() {
  arm::Table3 table;
  table.arms = {{
      {{0, 0, 0}, {1, {0, 0, 0}, small, small, 1.16, 0}},
      {{0, -0.3, 0.324}, {56.5, {0.172, 0, 0.205}, 2.58, 2.73, 0.64, -0.46}},
      {{0, 0, 0.65}, {26.4, {0.064, 0, -0.034}, 0.279, 0.413, 0.245, -0.070}},
      {{0, 0.155, 0.414}, {28.7, {0, 0, 0}, 1.67, 1.67, 0.081, 0}},
      {{0, 0, 0.186}, {5.2, {0, 0, 0}, 1.25, 1.53, 0.81, 0}},
      // Its own tensor, and that of the load, which is a point mass here.
      {{0, 0, 0.125}, {0.5, {0.05, -0.05, 0.05}, 2 * small, 2 * small, 2 * small, 0}},
  }};
  table.joint_limits.fill(arm::no_limit);
  table.shoulder_height = 0.351;
  return table;
}

// The inertia at the joint turns about a vertical axis: nothing weighs.
arm::Table3 one_axis_table_3() {
  arm::Table3 table;
  table.arms.fill({{0, 0, 0}, {0, {0, 0, 0}, 0, 0, 0, 0}});
  // Of the load [kg m^2]: with it the published reference was made.
  table.arms[0].body.I33 = 19.5;
  table.joint_limits.fill(arm::no_limit);
  return table;
}

// Axis 2 becomes the first and only one.
template <class Rows>
void move_axis_2_to_front(Rows& table) {
  Rows::for_each_row(table, [](const char*, const char*, drive::Sign, auto& row) {
    const auto of_axis_2 = row[1];
    std::ranges::fill(row, of_axis_2);
  });
}

}  // namespace

Tables default_tables(Model model) {
  if (!is_modelica(model)) return {drive::Table1{}, drive::Table2{}, arm::Table3{}};
  drive::ModelicaTable1 table_1;
  drive::Table2 table_2 = drive::modelica_table_2();
  if (model == Model::full_robot) return {table_1, table_2, full_robot_table_3()};
  move_axis_2_to_front(table_1);
  move_axis_2_to_front(table_2);
  return {table_1, table_2, one_axis_table_3()};
}

arm::Load default_load(Model model) {
  if (model != Model::full_robot) return {};
  return {.mass = 15, .position = {0.1, -0.1, 0.25}, .bounds = false};
}

void check(const Tables& tables) {
  std::visit([](const auto& table) { drive::check(table); }, tables.table_1);
  drive::check(tables.table_2);
  arm::check(tables.table_3);
}

}  // namespace manutec_r3::robot
