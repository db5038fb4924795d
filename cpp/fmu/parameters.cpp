#include "fmu/parameters.hpp"

#include <algorithm>
#include <array>
#include <stdexcept>
#include <string_view>
#include <utility>
#include <variant>

namespace manutec_r3::fmu {
namespace {

// What the symbols of the tables mean.
constexpr std::pair<std::string_view, std::string_view> texts[] = {
    {"table_1.K_V", "Gains of the position controllers"},
    {"table_1.K_D", "Gains of the feedforward of the reference rates"},
    {"table_1.K_S", "Gains of the rate controllers"},
    {"table_1.T_0", "Time constants of the rate controllers, numerator"},
    {"table_1.T_e", "Time constants of the rate controllers, denominator"},
    {"table_1.T_a", "Time constants of the feedback filters, numerator"},
    {"table_1.T_b", "Time constants of the feedback filters, denominator"},
    {"table_1.K_T", "Gains of the tachogenerators"},
    {"table_1.w_p", "Natural frequencies of the tachogenerators"},
    {"table_1.D_p", "Damping of the tachogenerators"},
    {"table_1.w_e", "Corner frequencies of the tachogenerators"},
    {"table_1.K_M", "Torques of the motors per voltage"},
    {"table_1.w_i", "Natural frequencies of the current-controlled motors"},
    {"table_1.D_i", "Damping of the current-controlled motors"},
    {"table_1.a", "Half widths of the dead zones NL1"},
    {"table_1.b", "Torque limits NL2 of the motors"},
    {"table_1.rF_max", "Largest motor torques for a short time; no effect on the motion"},
    {"table_1.rF_nom", "Nominal motor torques; no effect on the motion"},
    {"table_1.rotor_rate_max", "Largest rotor rates, motor side; no effect on the motion"},
    {"table_1.p", "Gear ratios, rotor rate over joint rate"},
    {"table_1.T", "Sampling time of the digital position controllers"},
    {"table_1.kp", "Gains of the position controllers"},
    {"table_1.ks", "Gains of the rate controllers"},
    {"table_1.Ts", "Integral times of the rate controllers"},
    {"table_1.w", "Natural frequencies of the current loops"},
    {"table_1.D", "Damping of the current loops"},
    {"table_1.k", "Torques of the motors per current"},
    {"table_2.b", "Half widths of the gears' backlash, motor side"},
    {"table_2.c", "Stiffnesses of the gears, motor side"},
    {"table_2.d", "Damping of the gears, motor side"},
    {"table_2.rM_h", "Sticking limits of friction, motor side"},
    {"table_2.friction", "Sliding friction, motor side: points of rotor rate [rad/s] and torque"},
    {"table_3.arm.offset", "Place of the joint in the frame of the arm before"},
    {"table_3.arm.mass", "Mass"},
    {"table_3.arm.centre_of_mass", "Centre of mass in the arm's frame"},
    {"table_3.arm.I11", "Moment of inertia about the centre of mass"},
    {"table_3.arm.I22", "Moment of inertia about the centre of mass"},
    {"table_3.arm.I33", "Moment of inertia about the centre of mass"},
    {"table_3.arm.I13", "Product of inertia about the centre of mass"},
    {"table_3.rJ", "Moments of inertia of the rotors, motor side"},
    {"table_3.gravity", "Gravity, along -z of the world"},
};

std::string text_of(const std::string& symbol) {
  const auto found = std::ranges::find(texts, std::string_view(symbol),
                                       &std::pair<std::string_view, std::string_view>::first);
  if (found == std::end(texts)) throw std::logic_error("no text for " + symbol);
  return std::string(found->second);
}

class Collector {
 public:
  Collector(std::vector<Parameter>& parameters, int n_columns)
      : parameters_(parameters), n_columns_(n_columns) {}

  // A number, or one of each axis.
  void add(const std::string& name, const std::string& unit, double& value) {
    add(name, name, unit, {}, {&value});
  }
  template <std::size_t size>
  void add(const std::string& name, const std::string& unit, std::array<double, size>& row) {
    const int n = std::min(n_columns_, static_cast<int>(size));
    std::vector<double*> places;
    for (int i = 0; i < n; ++i) places.push_back(&row[i]);
    add(name, name, unit, {n}, std::move(places));
  }

  // Each axis has a characteristic of its own.
  void add(const std::string& name, const std::string& unit,
           std::array<drive::FrictionPoints, 6>& characteristics) {
    for (int i = 0; i < n_columns_; ++i) {
      std::vector<double*> places;
      for (drive::FrictionPoint& point : characteristics[i]) {
        places.push_back(&point.rate);
        places.push_back(&point.torque);
      }
      const int n_points = static_cast<int>(characteristics[i].size());
      add(name + "_" + std::to_string(i + 1), name, unit, {n_points, 2}, std::move(places));
    }
  }

  template <class Bodily>
  void add_body(const std::string& name, Bodily& bodily) {
    const auto visit = [&]<class Value>(const char* symbol, const char* unit, Value& value) {
      std::vector<double*> places;
      std::vector<int> shape;
      if constexpr (std::is_same_v<Value, double>) {
        places = {&value};
      } else {
        shape = {3};
        places = {&value[0], &value[1], &value[2]};
      }
      add(name + "." + symbol, std::string("table_3.arm.") + symbol, unit, shape,
          std::move(places));
    };
    Bodily::for_each_number(bodily, visit);
  }

 private:
  void add(const std::string& name, const std::string& symbol, const std::string& unit,
           std::vector<int> shape, std::vector<double*> places) {
    parameters_.push_back({name, unit, text_of(symbol), std::move(shape), std::move(places)});
  }

  std::vector<Parameter>& parameters_;
  int n_columns_;
};

}  // namespace

std::vector<Parameter> parameters_of(robot::Model model, arm::Load& load, robot::Tables& tables) {
  std::vector<Parameter> parameters;
  const int n_axes = robot::n_axes(model);
  if (model != robot::Model::one_axis) {
    parameters = {{"load.mass", "kg", "Mass of the load", {}, {&load.mass}},
                  {"load.position",
                   "m",
                   "Place of the load in the frame of arm 6",
                   {3},
                   {&load.position[0], &load.position[1], &load.position[2]}}};
  }
  Collector collector(parameters, n_axes);
  const auto of_table = [&](const std::string& table) {
    return [&collector, table](const char* symbol, const char* unit, drive::Sign, auto& row) {
      collector.add(table + "." + symbol, unit, row);
    };
  };
  std::visit([&](auto& table) { table.for_each_row(table, of_table("table_1")); }, tables.table_1);
  if (robot::has_real_gears(model)) {
    drive::Table2::for_each_row(tables.table_2, of_table("table_2"));
  }
  // Arms beyond the joints that move count as well: the brakes hold what is there.
  const int n_arms = n_axes == 1 ? 1 : arm::n_axes;
  for (int j = 0; j < n_arms; ++j) {
    collector.add_body("table_3.arm_" + std::to_string(j + 1), tables.table_3.arms[j]);
  }
  if (!robot::is_modelica(model)) {
    collector.add_body("table_3.lumped_arm_3", tables.table_3.lumped_arm_3);
  }
  collector.add("table_3.rJ", "kg m^2", tables.table_3.rotor_inertia);
  collector.add("table_3.gravity", "m/s^2", tables.table_3.gravity);
  return parameters;
}

}  // namespace manutec_r3::fmu
