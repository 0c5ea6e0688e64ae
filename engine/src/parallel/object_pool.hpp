#pragma once

#include <memory>
#include <mutex>
#include <utility>
#include <vector>

namespace frontlux::detail {

/// Objects that tasks work with, one each, kept with the memory that they have grown for the tasks that
/// follow. Not thread-local: a task that waits may start another one on its thread. Thread safety: full.
template <class T>
class ObjectPool {
 public:
  /// One that no task uses, or what `make()` returns.
  template <class Make>
  [[nodiscard]] std::unique_ptr<T> take(const Make& make) {
    {
      const std::lock_guard lock(mutex_);
      if (!free_.empty()) {
        auto object = std::move(free_.back());
        free_.pop_back();
        return object;
      }
    }
    return make();
  }
  void give_back(std::unique_ptr<T> object) {
    const std::lock_guard lock(mutex_);
    free_.push_back(std::move(object));
  }

 private:
  std::mutex mutex_;
  std::vector<std::unique_ptr<T>> free_;
};

}  // namespace frontlux::detail
