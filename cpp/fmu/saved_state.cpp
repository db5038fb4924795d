// The state of an instance as bytes, for this program on this kind of machine: a signature, a
// checksum of what follows, and the state. Bytes that have suffered are no state: indices in it are
// used as they are.
#include <cstdint>
#include <cstring>
#include <map>
#include <stdexcept>
#include <string_view>
#include <type_traits>

#include "fmu/instance.hpp"

namespace manutec_r3::fmu {
namespace {

constexpr std::string_view signature = "manutec_r3 FMU state 4\n";

// FNV-1a: http://www.isthe.com/chongo/tech/comp/fnv
std::uint64_t checksum(std::span<const unsigned char> bytes) {
  std::uint64_t sum = 0xcbf29ce484222325;
  for (const unsigned char byte : bytes) sum = (sum ^ byte) * 0x100000001b3;
  return sum;
}

template <class Value>
concept Plain =
    std::is_arithmetic_v<Value> || std::is_enum_v<Value> || std::is_same_v<Value, hybrid::Element>;

class Writer {
 public:
  template <Plain Value>
  void operator()(const Value& value) {
    const auto* begin = reinterpret_cast<const unsigned char*>(&value);
    bytes_.insert(bytes_.end(), begin, begin + sizeof value);
  }
  template <class Value>
  void operator()(const std::vector<Value>& values) {
    (*this)(values.size());
    for (const Value& value : values) (*this)(value);
  }
  void operator()(const std::string& text) { (*this)(std::vector<char>(text.begin(), text.end())); }
  void operator()(const Eigen::ArrayXd& values) {
    (*this)(std::vector<double>(values.begin(), values.end()));
  }
  template <class Value>
  void operator()(const std::map<hybrid::Element, Value>& values) {
    (*this)(values.size());
    for (const auto& [key, value] : values) {
      (*this)(key);
      visit(*this, value);
    }
  }
  template <class Value>
  void operator()(const std::optional<Value>& value) {
    (*this)(value.has_value());
    if (value) visit(*this, *value);
  }

  std::vector<unsigned char> take() { return std::move(bytes_); }

 private:
  std::vector<unsigned char> bytes_;
};

class Reader {
 public:
  explicit Reader(std::span<const unsigned char> bytes) : rest_(bytes) {}

  template <Plain Value>
  void operator()(Value& value) {
    std::memcpy(&value, take(sizeof value), sizeof value);
  }
  template <class Value>
  void operator()(std::vector<Value>& values) {
    values.resize(size(sizeof(Value)));
    for (Value& value : values) (*this)(value);
  }
  void operator()(std::string& text) {
    std::vector<char> letters;
    (*this)(letters);
    text.assign(letters.begin(), letters.end());
  }
  void operator()(Eigen::ArrayXd& values) {
    std::vector<double> read;
    (*this)(read);
    values = Eigen::Map<const Eigen::ArrayXd>(read.data(), static_cast<Eigen::Index>(read.size()));
  }
  template <class Value>
  void operator()(std::map<hybrid::Element, Value>& values) {
    values.clear();
    for (std::size_t n = size(sizeof(hybrid::Element)); n > 0; --n) {
      hybrid::Element key{};
      (*this)(key);
      visit(*this, values[key]);
    }
  }
  template <class Value>
  void operator()(std::optional<Value>& value) {
    bool exists = false;
    (*this)(exists);
    value.reset();
    if (exists) visit(*this, value.emplace());
  }

  std::span<const unsigned char> rest() const { return rest_; }
  const unsigned char* take(std::size_t n) {
    if (n > rest_.size()) throw std::invalid_argument("FMU state: the bytes end too early");
    const unsigned char* begin = rest_.data();
    rest_ = rest_.subspan(n);
    return begin;
  }

 private:
  // Of a list whose elements take so many bytes at least: nothing is reserved for nonsense.
  std::size_t size(std::size_t of_element) {
    std::size_t n = 0;
    (*this)(n);
    if (n > rest_.size() / of_element) {
      throw std::invalid_argument("FMU state: the bytes end too early");
    }
    return n;
  }

  std::span<const unsigned char> rest_;
};

// Both read and write; const where they are written.
template <class Archive, class History>
  requires std::is_same_v<std::remove_const_t<History>, hybrid::ChatteringGuard::History>
void visit(Archive& archive, History& history) {
  archive(history.at_this_instant);
  archive(history.recent);
  archive(history.oldest);
}

template <class Archive, class Mode>
  requires std::is_same_v<std::remove_const_t<Mode>, hybrid::Mode>
void visit(Archive& archive, Mode& mode) {
  archive(mode.branches);
  archive(mode.held);
}

template <class Archive, class Step>
  requires std::is_same_v<std::remove_const_t<Step>, hybrid::Step>
void visit(Archive& archive, Step& step) {
  archive(step.t0);
  archive(step.t1);
  archive(step.dense);
}

template <class Archive, class Snapshot>
  requires std::is_same_v<std::remove_const_t<Snapshot>, hybrid::Simulation::Snapshot>
void visit(Archive& archive, Snapshot& snapshot) {
  auto& front = snapshot.front;
  archive(front.time);
  visit(archive, front.step);
  for (auto& step : front.before) visit(archive, step);
  archive(front.n_before);
  archive(front.x);
  archive(front.look.t);
  archive(front.look.is_glance);
  archive(front.look.z);
  archive(front.look.slope);
  archive(front.event);
  archive(front.time_event);
  archive(front.fired);
  archive(front.guard.histories());
  archive(snapshot.next_size);
  visit(archive, snapshot.mode);
}

template <class Archive, class Saved>
  requires std::is_same_v<std::remove_const_t<Saved>, SavedState>
void visit(Archive& archive, Saved& saved) {
  archive(saved.token);
  archive(saved.kind);
  archive(saved.phase);
  archive(saved.stop_time);
  archive(saved.row);
  archive(saved.tolerance);
  archive(saved.initialising);
  archive(saved.started);
  archive(saved.reference_since);
  archive(saved.input_changed);
  visit(archive, saved.mode);
  archive(saved.given);
  archive(saved.lift);
  archive(saved.fired);
  archive(saved.latest_event);
  archive(saved.simulation);
}

}  // namespace

std::vector<unsigned char> bytes_of(const SavedState& saved) {
  Writer state;
  visit(state, saved);
  const std::vector<unsigned char> bytes = state.take();
  Writer writer;
  for (const char letter : signature) writer(letter);
  writer(checksum(bytes));
  for (const unsigned char byte : bytes) writer(byte);
  return writer.take();
}

SavedState saved_state_from(std::span<const unsigned char> bytes) {
  Reader reader(bytes);
  if (std::memcmp(reader.take(signature.size()), signature.data(), signature.size()) != 0) {
    throw std::invalid_argument("FMU state: these bytes are none");
  }
  std::uint64_t sum = 0;
  reader(sum);
  if (checksum(reader.rest()) != sum) {
    throw std::invalid_argument("FMU state: the bytes have been changed");
  }
  SavedState saved;
  visit(reader, saved);
  return saved;
}

}  // namespace manutec_r3::fmu
