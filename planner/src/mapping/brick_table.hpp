#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace frontlux::planner::detail {

/// Values for bricks, by the number of the brick: a hash table with the values side by side, in the order in
/// which they came. Numbers are any that tell bricks apart.
template <class Value>
class BrickTable {
 public:
  struct Entry {
    std::uint64_t number;
    Value value;
  };

  /// The place of a brick's value, which is a new one if there was none. It never changes.
  std::size_t index(std::uint64_t number) {
    if (2 * (entries_.size() + 1) > slots_.size()) grow();
    std::uint32_t& slot = slots_[find_slot(number)];
    if (slot == 0) {
      entries_.push_back({number, Value{}});
      slot = static_cast<std::uint32_t>(entries_.size());
    }
    return slot - 1;
  }
  Value& value(std::size_t index) { return entries_[index].value; }
  Value& operator[](std::uint64_t number) { return value(index(number)); }

  /// Null if there is none.
  [[nodiscard]] const Value* find(std::uint64_t number) const {
    if (slots_.empty()) return nullptr;
    const std::uint32_t slot = slots_[find_slot(number)];
    return slot == 0 ? nullptr : &entries_[slot - 1].value;
  }

  [[nodiscard]] const std::vector<Entry>& entries() const { return entries_; }

  void clear() {
    entries_.clear();
    slots_.assign(slots_.size(), 0);
  }

 private:
  [[nodiscard]] std::size_t find_slot(std::uint64_t number) const {
    const std::size_t mask = slots_.size() - 1;
    auto at = static_cast<std::size_t>((number * 0x9E37'79B9'7F4A'7C15) >> 32) & mask;
    while (slots_[at] != 0 && entries_[slots_[at] - 1].number != number) at = (at + 1) & mask;
    return at;
  }

  void grow() {
    slots_.assign(slots_.empty() ? 64 : 2 * slots_.size(), 0);
    for (std::size_t i = 0; i < entries_.size(); ++i)
      slots_[find_slot(entries_[i].number)] = static_cast<std::uint32_t>(i + 1);
  }

  std::vector<std::uint32_t>
      slots_;  // place of the entry plus one; a power of two of them, half of them empty
  std::vector<Entry> entries_;
};

}  // namespace frontlux::planner::detail
