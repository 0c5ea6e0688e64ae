#pragma once

#include <frontlux/parallel.hpp>
#include <frontlux/ray.hpp>

#include <array>
#include <cstddef>
#include <exception>
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
    // What one throws, as for want of memory, must not cancel the loops of the other, Embree's among them:
    // those end with half of their work done.
    std::array<std::exception_ptr, 2> thrown;
    for_each_index(2, [&](std::size_t i) {
      try {
        values_[i] = make(static_cast<UnknownPolicy>(i));
      } catch (...) {
        thrown[i] = std::current_exception();
      }
    });
    for (const std::exception_ptr& error : thrown)
      if (error) std::rethrow_exception(error);
  }
  [[nodiscard]] const T& operator[](UnknownPolicy unknown) const {
    return *values_[static_cast<std::size_t>(unknown)];
  }

 private:
  std::array<std::unique_ptr<const T>, 2> values_;
};

}  // namespace frontlux::detail
