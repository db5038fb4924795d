// The linear blocks of a robot that its runs have made (linear_drives.hpp): the next run finds
// them.
#pragma once

#include <cstdint>
#include <map>
#include <mutex>
#include <utility>

#include "hybrid/linear_view.hpp"

namespace manutec_r3::robot {

class LinearBlocks {
 public:
  // Of an axis in a mode; of which, says the key. It lives as long as this. Any thread may ask.
  template <class Make>
  const hybrid::LinearBlock& find_or(int axis, std::uint64_t key, const Make& make) {
    const std::lock_guard lock(using_);
    const auto found = blocks_.find({axis, key});
    if (found != blocks_.end()) return found->second;
    return blocks_.emplace(std::pair{axis, key}, make()).first->second;
  }

 private:
  std::mutex using_;
  std::map<std::pair<int, std::uint64_t>, hybrid::LinearBlock> blocks_;
};

}  // namespace manutec_r3::robot
