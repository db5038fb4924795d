// What the numbers of the tables must be.
#include "drive/parameters.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>
#include <string>

#include "drive/modelica_parameters.hpp"

namespace manutec_r3::drive {
namespace {

// Shorter ones make runs that hardly advance [s].
constexpr double shortest_sampling_time = 1e-6;

[[noreturn]] void refuse(const std::string& where, const std::string& expected,
                         const std::string& unit, double got) {
  std::ostringstream message;
  message << where << ": expected " << expected << " [" << unit << "], got " << got;
  throw std::invalid_argument(message.str());
}

std::string of_axis(const std::string& where, std::size_t axis) {
  return where + " of axis " + std::to_string(axis + 1);
}

void require(const std::string& where, const std::string& unit, Sign sign, double value) {
  const bool good = sign == Sign::not_zero       ? value != 0.0
                    : sign == Sign::not_negative ? value >= 0.0
                                                 : value > 0.0;
  if (std::isfinite(value) && good) return;
  refuse(where,
         sign == Sign::not_zero       ? "a finite value other than 0"
         : sign == Sign::not_negative ? "a finite value of 0 or more"
                                      : "a positive finite value",
         unit, value);
}

// A row of a table, in its different shapes.
void check_row(const std::string& where, const std::string& unit, Sign sign, double value) {
  require(where, unit, sign, value);
}

template <std::size_t n>
void check_row(const std::string& where, const std::string& unit, Sign sign,
               const std::array<double, n>& row) {
  for (std::size_t i = 0; i < n; ++i) require(of_axis(where, i), unit, sign, row[i]);
}

void check_row(const std::string& where, const std::string& unit, Sign sign,
               const std::array<FrictionPoints, 6>& row) {
  for (std::size_t i = 0; i < row.size(); ++i) {
    const std::string here = of_axis(where, i);
    if (row[i].size() < 2) refuse(here, "two points or more", "rad/s, N m", row[i].size());
    double after = -1.0;
    for (const auto& [rate, torque] : row[i]) {
      require(here, unit, sign, torque);
      if (!std::isfinite(rate) || (after < 0.0 ? rate != 0.0 : rate <= after)) {
        refuse(here, "rates that begin at 0 and increase", "rad/s", rate);
      }
      after = rate;
    }
    // The last segment is extended.
    const double last = row[i].back().torque, last_but_one = row[i][row[i].size() - 2].torque;
    if (last < last_but_one) {
      std::ostringstream expected;
      expected << "a last torque of at least the one before, " << last_but_one;
      refuse(here, expected.str(), unit, last);
    }
  }
}

template <class Table>
void check_rows(const std::string& name, const Table& table) {
  Table::for_each_row(table,
                      [&name](const char* symbol, const char* unit, Sign sign, const auto& row) {
                        check_row(name + " " + symbol, unit, sign, row);
                      });
}

}  // namespace

void check(const Table1& table) {
  check_rows("table_1", table);
  if (table.sampling_time < shortest_sampling_time) {
    std::ostringstream expected;
    expected << "at least " << shortest_sampling_time;
    refuse("table_1 T", expected.str(), "s", table.sampling_time);
  }
}

void check(const ModelicaTable1& table) { check_rows("table_1", table); }

void check(const Table2& table) {
  check_rows("table_2", table);
  for (std::size_t i = 0; i < table.sticking_limit.size(); ++i) {
    const FrictionPoints& points = table.sliding_friction[i];
    const double rM_1 = points.front().torque;
    if (table.sticking_limit[i] < rM_1) {
      std::ostringstream expected;
      expected << "at least rM_1, the first point of friction, " << rM_1;
      refuse(of_axis("table_2 rM_h", i), expected.str(), "N m", table.sticking_limit[i]);
    }
    const bool slides_freely =
        std::ranges::all_of(points, [](const FrictionPoint& point) { return point.torque == 0.0; });
    if (table.sticking_limit[i] == 0.0 && !slides_freely) {
      refuse(of_axis("table_2 rM_h", i), "a positive limit where there is friction", "N m", 0.0);
    }
  }
}

}  // namespace manutec_r3::drive
