// The tables of a robot as Python dictionaries, and back. Each row has one entry per axis.
#include "robot/tables.hpp"

#include <pybind11/stl.h>

#include <algorithm>
#include <array>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "bindings/bindings.hpp"
#include "bindings/robot_options.hpp"

namespace manutec_r3::bindings {
namespace {

using arm::Axis;
using drive::FrictionPoints;

constexpr std::array<const char*, 3> letters = {"x", "y", "z"};

const char* letter(Axis axis) { return letters[static_cast<std::size_t>(axis)]; }

// --- to Python ----------------------------------------------------------------------------------

py::object entry(double value) { return py::float_(value); }

py::object entry(Axis axis) { return py::str(letter(axis)); }

py::object entry(const FrictionPoints& points) {
  py::list pairs;
  for (const drive::FrictionPoint& point : points) {
    pairs.append(py::make_tuple(point.rate, point.torque));
  }
  return py::tuple(pairs);
}

// An arm, or a body.
template <class Bodily>
  requires std::is_same_v<Bodily, arm::Body> || std::is_same_v<Bodily, arm::Arm>
py::object entry(const Bodily& bodily) {
  py::dict entries;
  Bodily::for_each_number(
      bodily, [&](const char* symbol, const char*, const auto& value) { entries[symbol] = value; });
  return entries;
}

// The first entries of a row; robots of one axis have one. Numbers make a list.
template <class Value, std::size_t size>
py::object as_python(const std::array<Value, size>& row, int n_columns) {
  py::list entries;
  const int n = std::min(n_columns, static_cast<int>(size));
  for (int i = 0; i < n; ++i) entries.append(entry(row[i]));
  if constexpr (std::is_same_v<Value, double>) return entries;
  return py::tuple(entries);
}

template <class Value>
py::object as_python(const Value& value, int) {
  return entry(value);
}

template <class Table>
py::dict as_dict(const Table& table, int n_columns) {
  py::dict rows;
  Table::for_each_row(table, [&](const char* symbol, const char*, drive::Sign, const auto& row) {
    rows[symbol] = as_python(row, n_columns);
  });
  return rows;
}

py::dict as_dict(const arm::Table3& table, int n_columns, bool has_lumped_arm) {
  py::dict rows;
  const auto add = [&](const char* symbol, const char*, const auto& row) {
    rows[symbol] = as_python(row, n_columns);
  };
  arm::Table3::for_each_row(table, add);
  int j = 0;
  for (const py::handle arm : rows["arms"]) arm["axis"] = letter(arm::joint_axes[j++]);
  rows["lumped_arm_3"]["axis"] = letter(arm::joint_axes[2]);
  if (!has_lumped_arm) rows.attr("pop")("lumped_arm_3");
  return rows;
}

// --- from Python --------------------------------------------------------------------------------

void read(const py::handle& from, double& value) { value = from.cast<double>(); }

void read(const py::handle& from, Axis& axis) {
  const auto place = std::ranges::find(letters, from.cast<std::string>());
  if (place == letters.end()) {
    throw std::invalid_argument("table_3 rn: expected 'x', 'y' or 'z', got " +
                                py::repr(from).cast<std::string>());
  }
  axis = static_cast<Axis>(place - letters.begin());
}

void read(const py::handle& from, FrictionPoints& points) {
  points.clear();
  for (const auto& [rate, torque] : from.cast<std::vector<std::pair<double, double>>>()) {
    points.push_back({rate, torque});
  }
}

template <class Bodily>
  requires std::is_same_v<Bodily, arm::Body> || std::is_same_v<Bodily, arm::Arm>
void read(const py::handle& from, Bodily& bodily) {
  Bodily::for_each_number(bodily, [&](const char* symbol, const char*, auto& value) {
    value = from[symbol].template cast<std::remove_reference_t<decltype(value)>>();
  });
}

template <class Value, std::size_t size>
void read(const py::handle& from, std::array<Value, size>& row) {
  std::size_t i = 0;
  for (const py::handle entry : py::cast<py::sequence>(from)) read(entry, row.at(i++));
}

template <class Table>
void read_table(const py::dict& rows, Table& table) {
  Table::for_each_row(table, [&](const char* symbol, const char*, drive::Sign, auto& row) {
    read(rows[symbol], row);
  });
}

void read_table(const py::dict& rows, arm::Table3& table) {
  arm::Table3::for_each_row(table, [&](const char* symbol, const char*, auto& row) {
    if (rows.contains(symbol)) read(rows[symbol], row);
  });
}

// --- units --------------------------------------------------------------------------------------

// Of the rows of a table, by their symbols.
template <class Table>
py::dict units_of(const Table& table) {
  py::dict units;
  Table::for_each_row(
      table, [&](const char* symbol, const char* unit, const auto&...) { units[symbol] = unit; });
  return units;
}

// Of Table 3, with those of its arms.
py::dict units_of(const arm::Table3& table) {
  py::dict units = units_of<arm::Table3>(table);
  arm::Arm::for_each_number(table.arms[0], [&](const char* symbol, const char* unit, const auto&) {
    units[symbol] = unit;
  });
  return units;
}

}  // namespace

py::dict as_dict(const robot::Tables& tables, robot::Model model) {
  // Models with three arms show all six columns: their brakes hold axes that are there.
  const int n_columns = robot::n_axes(model) == 1 ? 1 : arm::n_axes;
  py::dict dict;
  dict["table_1"] =
      std::visit([&](const auto& table) { return as_dict(table, n_columns); }, tables.table_1);
  dict["table_2"] = as_dict(tables.table_2, n_columns);
  dict["table_3"] = as_dict(tables.table_3, n_columns, !robot::is_modelica(model));
  return dict;
}

robot::Tables tables_from(const py::dict& dict, robot::Model model) {
  robot::Tables tables = robot::default_tables(model);
  std::visit([&](auto& table) { read_table(dict["table_1"].cast<py::dict>(), table); },
             tables.table_1);
  read_table(dict["table_2"].cast<py::dict>(), tables.table_2);
  read_table(dict["table_3"].cast<py::dict>(), tables.table_3);
  return tables;
}

void register_tables(py::module_& module) {
  module.def("default_tables", [](const py::object& model) {
    return as_dict(robot::default_tables(model_named(model)), model_named(model));
  });
  module.def("table_units", [](const py::object& model) {
    const robot::Tables tables = robot::default_tables(model_named(model));
    py::dict units;
    units["table_1"] =
        std::visit([](const auto& table) { return units_of(table); }, tables.table_1);
    units["table_2"] = units_of(tables.table_2);
    units["table_3"] = units_of(tables.table_3);
    return units;
  });
}

}  // namespace manutec_r3::bindings
