#pragma once

#include <cstddef>
#include <memory>
#include <mutex>
#include <utility>

namespace frontlux::detail {

/// Keeps a value that no query uses any more: to update it costs less than to make a new one.
template <class T>
class Spare {
 public:
  /// Null if there is none.
  [[nodiscard]] std::unique_ptr<T> take() {
    const std::lock_guard lock(mutex_);
    return std::move(value_);
  }
  /// What `measure` returns for it, or 0 if there is none.
  template <class Measure>
  [[nodiscard]] std::size_t measured(const Measure& measure) const {
    const std::lock_guard lock(mutex_);
    return value_ ? measure(*value_) : 0;
  }
  void give_back(std::unique_ptr<T> value) {
    const std::lock_guard lock(mutex_);
    if (!value_) value_ = std::move(value);  // one is enough: updates do not overlap
  }

 private:
  mutable std::mutex mutex_;
  std::unique_ptr<T> value_;
};

}  // namespace frontlux::detail
