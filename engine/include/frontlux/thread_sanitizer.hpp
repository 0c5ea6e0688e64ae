#pragma once

#if defined(__SANITIZE_THREAD__)
#define FRONTLUX_THREAD_SANITIZER 1
#elif defined(__has_feature)
#if __has_feature(thread_sanitizer)
#define FRONTLUX_THREAD_SANITIZER 1
#endif
#endif
#ifdef FRONTLUX_THREAD_SANITIZER
extern "C" void __tsan_acquire(void* address);
extern "C" void __tsan_release(void* address);
#endif

/// Where threads hand over work through TBB or Embree, which are not built with the thread sanitizer: it does
/// not see that what one thread did before `hand_over` has happened for whoever calls `take_over` later, with
/// the same address. Nothing in other builds. Not part of the public interface.
namespace frontlux::detail {

inline void hand_over([[maybe_unused]] const void* address) {
#ifdef FRONTLUX_THREAD_SANITIZER
  __tsan_release(const_cast<void*>(address));
#endif
}

inline void take_over([[maybe_unused]] const void* address) {
#ifdef FRONTLUX_THREAD_SANITIZER
  __tsan_acquire(const_cast<void*>(address));
#endif
}

/// A loop in parallel: make one before it, and a Part at the beginning of each piece of work.
class ForkAndJoin {
 public:
  ForkAndJoin() { hand_over(&fork_); }
  ~ForkAndJoin() { take_over(&join_); }
  ForkAndJoin(const ForkAndJoin&) = delete;
  ForkAndJoin& operator=(const ForkAndJoin&) = delete;

  class Part {
   public:
    explicit Part(const ForkAndJoin& whole) : whole_(whole) { take_over(&whole_.fork_); }
    ~Part() { hand_over(&whole_.join_); }
    Part(const Part&) = delete;
    Part& operator=(const Part&) = delete;

   private:
    const ForkAndJoin& whole_;
  };

 private:
  char fork_ = 0, join_ = 0;  // their addresses alone are of use
};

}  // namespace frontlux::detail
