#pragma once

#include <frontlux/parallel.hpp>
#include <frontlux/ray.hpp>

#include <array>
#include <cstddef>
#include <memory>

namespace frontlux::detail {

/// One value for each `UnknownPolicy`.
template <class T>
class ByPolicy {
 public:
  /// Makes both at the same time.
  /// @param make  returns a std::unique_ptr to the value for a policy
  template <class Make>
  explicit ByPolicy(const Make& make) {
    for_each_index(2, [&](std::size_t i) { values_[i] = make(static_cast<UnknownPolicy>(i)); });
  }
  [[nodiscard]] const T& operator[](UnknownPolicy unknown) const {
    return *values_[static_cast<std::size_t>(unknown)];
  }

 private:
  std::array<std::unique_ptr<const T>, 2> values_;
};

}  // namespace frontlux::detail
