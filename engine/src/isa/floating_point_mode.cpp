#include <frontlux/floating_point_mode.hpp>

#ifdef __SSE2__
#include <xmmintrin.h>
#endif

namespace frontlux {
namespace {

#if defined(__SSE2__)
// MXCSR: exceptions masked; flush to zero, denormals are zero. The flags tell of exceptions that there were.
constexpr std::uint64_t kStandard = 0x1F80, kFlushing = kStandard | 0x8000 | 0x0040, kFlags = 0x3F;
std::uint64_t read() { return _mm_getcsr(); }
void write(std::uint64_t mode) { _mm_setcsr(static_cast<unsigned>(mode)); }
#elif defined(__aarch64__)
// FPCR: flush to zero. Its flags are in another register.
constexpr std::uint64_t kStandard = 0, kFlushing = std::uint64_t{1} << 24, kFlags = 0;
std::uint64_t read() {
  std::uint64_t mode = 0;
  __asm__ volatile("mrs %0, fpcr" : "=r"(mode));
  return mode;
}
void write(std::uint64_t mode) { __asm__ volatile("msr fpcr, %0" : : "r"(mode)); }
#else
#error "Embree runs on x86-64 and 64-bit ARM"
#endif

}  // namespace

// Writing takes longer than a short ray, so it is left out where it would change nothing.
FloatingPointMode::FloatingPointMode(Mode mode) : saved_(read()) {
  const std::uint64_t wanted = mode == kFlushed ? kFlushing : kStandard;
  changed_ = (saved_ & ~kFlags) != wanted;
  if (changed_) write(wanted);
}
FloatingPointMode::~FloatingPointMode() {
  if (changed_) write(saved_);
}

}  // namespace frontlux
