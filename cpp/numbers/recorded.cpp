#include "numbers/recorded.hpp"

#include <array>
#include <cmath>

namespace manutec_r3::numbers {

// --- the tape ------------------------------------------------------------------------------------

Recorded Tape::input() {
  lines_.push_back({Operation::input});
  return {this, static_cast<int>(lines_.size()) - 1};
}

int Tape::place_of(const Recorded& number) {
  if (!number.is_constant()) return number.place_;
  return write({.operation = Operation::constant, .constant = number.constant_});
}

Recorded Tape::record(Operation operation, const Recorded& operand) {
  return {this, write({operation, place_of(operand)})};
}

Recorded Tape::record(Operation operation, const Recorded& first, const Recorded& second) {
  const int first_place = place_of(first), second_place = place_of(second);
  return {this, write({operation, first_place, second_place})};
}

int Tape::write(const Line& line) {
  const auto [known, is_new] = places_.try_emplace(line, static_cast<int>(lines_.size()));
  if (is_new) lines_.push_back(line);
  return known->second;
}

std::string_view name_of(Tape::Operation operation) {
  static constexpr std::array<std::string_view, 8> names = {
      "input", "constant", "add", "subtract", "multiply", "negate", "sine", "cosine"};
  return names[static_cast<int>(operation)];
}

// --- operations ----------------------------------------------------------------------------------

using enum Tape::Operation;

Recorded operator+(const Recorded& a, const Recorded& b) {
  if (a.is_constant() && b.is_constant()) return a.constant_ + b.constant_;
  if (a.is(0)) return b;
  if (b.is(0)) return a;
  return (a.is_constant() ? b : a).tape_->record(add, a, b);
}

Recorded operator-(const Recorded& a, const Recorded& b) {
  if (a.is_constant() && b.is_constant()) return a.constant_ - b.constant_;
  if (a.is(0)) return -b;
  if (b.is(0)) return a;
  return (a.is_constant() ? b : a).tape_->record(subtract, a, b);
}

Recorded operator*(const Recorded& a, const Recorded& b) {
  if (a.is_constant() && b.is_constant()) return a.constant_ * b.constant_;
  if (a.is(0) || b.is(0)) return 0.0;
  if (a.is(1)) return b;
  if (b.is(1)) return a;
  return (a.is_constant() ? b : a).tape_->record(multiply, a, b);
}

Recorded operator-(const Recorded& a) {
  return a.is_constant() ? Recorded(-a.constant_) : a.tape_->record(negate, a);
}

Recorded sin(const Recorded& a) {
  return a.is_constant() ? Recorded(std::sin(a.constant_)) : a.tape_->record(sine, a);
}

Recorded cos(const Recorded& a) {
  return a.is_constant() ? Recorded(std::cos(a.constant_)) : a.tape_->record(cosine, a);
}

}  // namespace manutec_r3::numbers
