#pragma once

#if defined(__SSE2__)
#include <xmmintrin.h>
#endif

#include <cstdint>

namespace frontlux {

/// How this thread computes with floating-point numbers, for as long as the object lives; then the caller's
/// mode comes back, exception flags included.
class FloatingPointMode {
 public:
  enum Mode : std::uint8_t {
    kToNearest,  ///< as the standard has it: rounded to the nearest, tiny numbers kept
    kFlushed     ///< as Embree wants it while it works: tiny (denormal) numbers become zero
  };

  explicit FloatingPointMode(Mode mode) : saved_(read()) { write(mode == kFlushed ? kFlushing : kStandard); }
  ~FloatingPointMode() { write(saved_); }
  FloatingPointMode(const FloatingPointMode&) = delete;
  FloatingPointMode& operator=(const FloatingPointMode&) = delete;

 private:
#if defined(__SSE2__)
  using Register = unsigned;  // MXCSR: exceptions masked; flush to zero, denormals are zero
  static constexpr Register kStandard = 0x1F80, kFlushing = kStandard | 0x8000 | 0x0040;
  static Register read() { return _mm_getcsr(); }
  static void write(Register mode) { _mm_setcsr(mode); }
#elif defined(__aarch64__)
  using Register = std::uint64_t;  // FPCR: flush to zero
  static constexpr Register kStandard = 0, kFlushing = Register{1} << 24;
  static Register read() {
    Register mode = 0;
    __asm__ volatile("mrs %0, fpcr" : "=r"(mode));
    return mode;
  }
  static void write(Register mode) { __asm__ volatile("msr fpcr, %0" : : "r"(mode)); }
#else
  using Register = unsigned;  // Embree runs on no other processor
  static constexpr Register kStandard = 0, kFlushing = 0;
  static Register read() { return 0; }
  static void write(Register) {}
#endif

  Register saved_;
};

}  // namespace frontlux
