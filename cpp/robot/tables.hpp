// The tables of one robot: Tables 1 to 3 of the report, or what stands in their place in the
// Modelica variant.
#pragma once

#include <variant>

#include "arm/load.hpp"
#include "arm/parameters.hpp"
#include "drive/modelica_parameters.hpp"
#include "drive/parameters.hpp"
#include "robot/options.hpp"

namespace manutec_r3::robot {

struct Tables {
  std::variant<drive::Table1, drive::ModelicaTable1> table_1;
  drive::Table2 table_2;
  arm::Table3 table_3;

  const drive::Row& gear_ratio() const {
    return std::visit([](const auto& table) -> const drive::Row& { return table.gear_ratio; },
                      table_1);
  }
  bool operator==(const Tables&) const = default;
};

Tables default_tables(Model model);

// The load that a model carries if nothing else is asked for.
arm::Load default_load(Model model);

// Throws std::invalid_argument, naming table, symbol and axis.
void check(const Tables& tables);

}  // namespace manutec_r3::robot
