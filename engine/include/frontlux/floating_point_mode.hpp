#pragma once

#include <frontlux/export.hpp>

#include <cstdint>

namespace frontlux {

/// How this thread computes with floating-point numbers, for as long as the object lives; then the caller's
/// mode comes back. Exceptions are masked meanwhile; their flags (`std::fetestexcept`) may be raised.
class FRONTLUX_EXPORT FloatingPointMode {
 public:
  /// How floating-point numbers are rounded.
  enum Mode : std::uint8_t {
    kToNearest,  ///< as the standard has it: rounded to the nearest, tiny numbers kept
    kFlushed     ///< as Embree wants it while it works: tiny (denormal) numbers become zero
  };

  /// Sets the mode of this thread.
  explicit FloatingPointMode(Mode mode);
  ~FloatingPointMode();
  FloatingPointMode(const FloatingPointMode&) = delete;
  FloatingPointMode& operator=(const FloatingPointMode&) = delete;

 private:
  std::uint64_t saved_;  // the processor's control register
  bool changed_ = false;
};

}  // namespace frontlux
