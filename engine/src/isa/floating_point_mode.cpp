#include <frontlux/floating_point_mode.hpp>

#ifdef __SSE2__
#include <xmmintrin.h>
#endif

namespace frontlux {
namespace {

#if defined(__SSE2__)
// MXCSR: exceptions masked; flush to zero, denormals are zero.
constexpr std::uint64_t kStandard = 0x1F80, kFlushing = kStandard | 0x8000 | 0x0040;
std::uint64_t read() { return _mm_getcsr(); }
void write(std::uint64_t mode) { _mm_setcsr(static_cast<unsigned>(mode)); }
#elif defined(__aarch64__)
// FPCR: flush to zero.
constexpr std::uint64_t kStandard = 0, kFlushing = std::uint64_t{1} << 24;
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

FloatingPointMode::FloatingPointMode(Mode mode) : saved_(read()) {
  write(mode == kFlushed ? kFlushing : kStandard);
}
FloatingPointMode::~FloatingPointMode() { write(saved_); }

}  // namespace frontlux
