#include "fmu/recipe.hpp"

#include <algorithm>
#include <cmath>
#include <istream>
#include <limits>
#include <locale>
#include <span>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "fmu/parameters.hpp"

namespace manutec_r3::fmu {
namespace {

using motion::Motion;
using motion::Piece;
using motion::Polynomials;

constexpr const char* infinite = "inf";
constexpr std::array<std::string_view, 3> axes = {"x", "y", "z"};
constexpr std::array<std::string_view, 2> starts = {"rotor", "arm"};
constexpr std::array<std::string_view, 3> methods = {"erk", "bdf", "exponential"};
constexpr std::array<std::string_view, 4> controllers = {"continuous", "sampled", "external",
                                                         "none"};

// --- words and numbers --------------------------------------------------------------------------

// One line: a name, and what belongs to it.
class Writer {
 public:
  Writer() {
    text_.imbue(std::locale::classic());
    text_.precision(std::numeric_limits<double>::max_digits10);
  }

  template <class... Entries>
  void line(const std::string& name, const Entries&... entries) {
    text_ << name;
    (put(entries), ...);
    text_ << '\n';
  }

  std::string text() const { return text_.str(); }

 private:
  void put(std::string_view word) { text_ << ' ' << word; }
  void put(int number) { text_ << ' ' << number; }
  void put(double number) {
    if (std::isinf(number)) return put(std::string_view(infinite));
    text_ << ' ' << number;
  }
  void put(std::span<const double> numbers) {
    for (const double number : numbers) put(number);
  }

  std::ostringstream text_;
};

class Reader {
 public:
  explicit Reader(std::istream& text) : text_(text) { text_.imbue(std::locale::classic()); }

  // The next line begins with this name.
  Reader& line(const std::string& name) {
    name_ = name;
    if (word() != name) refuse("a line of this name");
    return *this;
  }

  std::string word() {
    std::string word;
    if (!(text_ >> word)) refuse("more text");
    return word;
  }

  int integer() {
    const double number = this->number();
    if (!(std::abs(number) <= std::numeric_limits<int>::max()) || number != std::floor(number)) {
      refuse("a whole number");
    }
    return static_cast<int>(number);
  }

  double number() {
    const std::string word = this->word();
    if (word == infinite) return std::numeric_limits<double>::infinity();
    std::istringstream digits(word);
    digits.imbue(std::locale::classic());
    double number = 0.0;
    if (!(digits >> number)) refuse("a number");
    return number;
  }

  std::vector<double> numbers(std::size_t n) {
    std::vector<double> numbers(n);
    for (double& number : numbers) number = this->number();
    return numbers;
  }

  // The place of a word in a list.
  template <class Value, std::size_t n>
  Value choice(const std::array<std::string_view, n>& words) {
    const std::string word = this->word();
    const auto place = std::ranges::find(words, std::string_view(word));
    if (place == words.end()) refuse("a known word, not " + word);
    return static_cast<Value>(place - words.begin());
  }

 private:
  [[noreturn]] void refuse(const std::string& expected) const {
    throw std::invalid_argument("resources, " + name_ + ": expected " + expected);
  }

  std::istream& text_;
  std::string name_;
};

// --- motions ------------------------------------------------------------------------------------

// A piece as one polynomial, with its time counted from the beginning of the whole motion.
Polynomials polynomials_of(const Motion& motion, int number, double begin) {
  if (number < 0) {
    Polynomials rest{.begin = begin, .length = 1.0};
    std::ranges::copy(motion.start(), rest.coefficients[0].begin());
    return rest;
  }
  const auto& law = motion.pieces()[number].law;
  if (const auto* polynomials = std::get_if<Polynomials>(&law)) {
    Polynomials shifted = *polynomials;
    shifted.begin += begin;
    return shifted;
  }
  if (const auto* member = std::get_if<motion::PieceOfMotion>(&law)) {
    return polynomials_of(*member->motion, member->piece, begin + member->begin);
  }
  throw std::invalid_argument(
      "motion: expected polynomials of time, got functions, which no file can hold");
}

// A motion, or no more of it than where it starts.
void write(Writer& writer, const Motion& motion, bool only_start) {
  const int n_pieces = only_start ? 0 : static_cast<int>(motion.pieces().size());
  writer.line("motion", motion.n_axes(), n_pieces, motion.duration());
  writer.line("motion.start", motion.start());
  for (int number = 0; number < n_pieces; ++number) {
    const Polynomials law = polynomials_of(motion, number, 0.0);
    writer.line("motion.piece", motion.pieces()[number].begin, law.begin, law.length);
    for (const auto& of_axes : law.coefficients) {
      writer.line("motion.coefficients", std::span<const double>(of_axes));
    }
  }
}

std::shared_ptr<const Motion> read_motion(Reader& reader, int n_axes) {
  reader.line("motion");
  const int n = reader.integer();
  const int n_pieces = reader.integer();
  if (n == 0) return {};
  if (n != n_axes) {
    throw std::invalid_argument("resources, motion: expected " + std::to_string(n_axes) +
                                " axes, got " + std::to_string(n));
  }
  const double duration = reader.number();
  std::vector<double> start = reader.line("motion.start").numbers(n_axes);
  std::vector<Piece> pieces;
  for (int number = 0; number < n_pieces; ++number) {
    reader.line("motion.piece");
    Piece piece{.begin = reader.number(), .law = Polynomials{}};
    auto& law = std::get<Polynomials>(piece.law);
    law.begin = reader.number();
    law.length = reader.number();
    for (auto& of_axes : law.coefficients) {
      reader.line("motion.coefficients");
      for (double& coefficient : of_axes) coefficient = reader.number();
    }
    pieces.push_back(piece);
  }
  return std::make_shared<Motion>(std::move(start), std::move(pieces), duration);
}

// --- the robot ----------------------------------------------------------------------------------

void write(Writer& writer, const robot::Robot& robot) {
  const robot::Options& options = robot.options();
  writer.line("model", robot::name_of(robot.model()));
  writer.line("controller", controllers[static_cast<int>(options.controller)]);
  for (const robot::Coupling coupling : options.coupling) {
    writer.line("rotor_coupling", robot::name_of(coupling, robot::coupling_names));
  }
  writer.line("gear_damping", robot::name_of(options.gear_damping, robot::gear_damping_names));
  writer.line("stiction", robot::name_of(options.stiction, robot::stiction_names));
  writer.line("stiffness", options.stiffness);
  writer.line("arm", robot::name_of(options.arm, robot::arm_names));
  writer.line("creep_rate", options.creep_rate);
  writer.line("voltage_limit", options.voltage_limit);

  arm::Load load = robot.load();
  robot::Tables tables = robot.tables();
  writer.line("load.bounds", static_cast<int>(load.bounds));
  for (const arm::Axis axis : tables.table_3.rotor_axes) {
    writer.line("table_3.rn", axes[static_cast<int>(axis)]);
  }
  for (const drive::FrictionPoints& points : tables.table_2.sliding_friction) {
    writer.line("friction_points", static_cast<int>(points.size()));
  }
  for (const Parameter& parameter : parameters_of(robot.model(), load, tables)) {
    std::vector<double> values;
    for (const double* place : parameter.places) values.push_back(*place);
    writer.line(parameter.name, std::span<const double>(values));
  }
}

robot::Model read_model(Reader& reader) {
  const std::string name = reader.line("model").word();
  for (int number = 1; number <= static_cast<int>(robot::Model::one_axis); ++number) {
    const auto model = static_cast<robot::Model>(number);
    if (robot::name_of(model) == name) return model;
  }
  throw std::invalid_argument("resources, model: expected one that is known, got " + name);
}

std::shared_ptr<const robot::Robot> read_robot(Reader& reader) {
  const robot::Model model = read_model(reader);
  robot::Options options = robot::default_options(model);
  options.controller = reader.line("controller").choice<robot::Controller>(controllers);
  for (robot::Coupling& coupling : options.coupling) {
    coupling = reader.line("rotor_coupling").choice<robot::Coupling>(robot::coupling_names);
  }
  options.gear_damping =
      reader.line("gear_damping").choice<drive::GearDamping>(robot::gear_damping_names);
  options.stiction = reader.line("stiction").choice<robot::Stiction>(robot::stiction_names);
  options.stiffness = reader.line("stiffness").number();
  options.arm = reader.line("arm").choice<robot::ArmData>(robot::arm_names);
  options.creep_rate = reader.line("creep_rate").number();
  options.voltage_limit = reader.line("voltage_limit").number();

  arm::Load load = robot::default_load(model);
  robot::Tables tables = robot::default_tables(model);
  load.bounds = reader.line("load.bounds").integer() != 0;
  for (arm::Axis& axis : tables.table_3.rotor_axes) {
    axis = reader.line("table_3.rn").choice<arm::Axis>(axes);
  }
  for (drive::FrictionPoints& points : tables.table_2.sliding_friction) {
    points.resize(reader.line("friction_points").integer());
  }
  for (const Parameter& parameter : parameters_of(model, load, tables)) {
    reader.line(parameter.name);
    for (double* place : parameter.places) *place = reader.number();
  }
  return std::make_shared<robot::Robot>(model, load, options, tables);
}

}  // namespace

std::string as_text(const Recipe& recipe) {
  Writer writer;
  write(writer, *recipe.robot);
  if (recipe.motion) {
    write(writer, *recipe.motion, recipe.reference_is_input);
  } else {
    writer.line("motion", 0, 0);
  }
  writer.line("reference_is_input", static_cast<int>(recipe.reference_is_input));
  if (const auto* start = std::get_if<robot::Start>(&recipe.start)) {
    writer.line("start", starts[static_cast<int>(*start)]);
  } else {
    writer.line("start", std::string_view("state"));
    writer.line("state", std::span<const double>(std::get<std::vector<double>>(recipe.start)));
  }
  writer.line("input", std::span<const double>(recipe.input));
  writer.line("tip_force", std::span<const double>(recipe.tip_force));
  for (const bool on : recipe.brakes) writer.line("brake", static_cast<int>(on));
  writer.line("method", methods[static_cast<int>(recipe.method)]);
  writer.line("relative_tolerance", recipe.relative_tolerance);
  return writer.text();
}

Recipe recipe_from(std::istream& text) {
  Reader reader(text);
  Recipe recipe{.robot = read_robot(reader)};
  recipe.motion = read_motion(reader, recipe.robot->n_axes());
  recipe.reference_is_input = reader.line("reference_is_input").integer() != 0;
  const std::string start = reader.line("start").word();
  if (start == "state") {
    recipe.start = reader.line("state").numbers(recipe.robot->n_states());
  } else {
    recipe.start = start == starts[0] ? robot::Start::rotor : robot::Start::arm;
  }
  const int n_axes = recipe.robot->n_axes();
  recipe.input = reader.line("input").numbers(n_axes);
  std::ranges::copy(reader.line("tip_force").numbers(3), recipe.tip_force.begin());
  for (int i = 0; i < n_axes; ++i) {
    recipe.brakes.push_back(reader.line("brake").integer() != 0);
  }
  recipe.method = reader.line("method").choice<solver::Method>(methods);
  recipe.relative_tolerance = reader.line("relative_tolerance").number();
  return recipe;
}

}  // namespace manutec_r3::fmu
