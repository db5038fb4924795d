#include "check.hpp"

#include <string_view>
#include <utility>
#include <vector>

namespace manutec_r3::testing {
namespace {

std::vector<std::pair<std::string_view, Body>>& cases() {
  static std::vector<std::pair<std::string_view, Body>> cases;
  return cases;
}

int failures = 0;

}  // namespace

Registration::Registration(const char* name, Body body) { cases().emplace_back(name, body); }

void fail(const char* file, int line, const std::string& what) {
  ++failures;
  std::cout << file << ":" << line << ": " << what << "\n";
}

}  // namespace manutec_r3::testing

// Runs the tests that are named, or all.
int main(int argc, char** argv) {
  using namespace manutec_r3::testing;
  int run = 0;
  for (const auto& [name, body] : cases()) {
    bool wanted = argc == 1;
    for (int i = 1; i < argc; ++i) wanted |= name == argv[i];
    if (!wanted) continue;
    ++run;
    const int before = failures;
    try {
      body();
    } catch (const std::exception& exception) {
      ++failures;
      std::cout << "threw: " << exception.what() << "\n";
    }
    if (failures > before) std::cout << "FAILED: " << name << "\n";
  }
  if (run == 0) std::cout << "no such test\n";
  return failures > 0 || run == 0;
}
