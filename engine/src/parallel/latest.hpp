#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <memory>
#include <mutex>
#include <utility>

namespace frontlux::detail {

/// The latest of the values that a writer sets. Readers keep the one that they got for as long as they need
/// it. Readers and writer wait for each other no longer than it takes to copy a pointer. Each stripe has its
/// own lock and its own reference count, so that threads that cast single rays do not compete for one cache
/// line.
template <class T>
class Latest {
 public:
  explicit Latest(std::shared_ptr<const T> value) { set(std::move(value)); }

  [[nodiscard]] std::shared_ptr<const T> get() const {
    Stripe& stripe = stripes_[stripe_of_this_thread()];
    const std::lock_guard lock(stripe.mutex);
    return stripe.value;
  }

  void set(std::shared_ptr<const T> value) {
    // Second owners with counts of their own keep the first alive. All are made before any is seen, since
    // there may be no memory for one.
    std::array<std::shared_ptr<const T>, kStripes> copies;
    for (auto& copy : copies) copy = std::shared_ptr<const T>(value.get(), [value](const T*) {});
    // All at once: who hears of the new value from another thread gets no older one.
    std::array<std::unique_lock<std::mutex>, kStripes> locks;
    for (std::size_t i = 0; i < kStripes; ++i) locks[i] = std::unique_lock(stripes_[i].mutex);
    for (std::size_t i = 0; i < kStripes; ++i) stripes_[i].value.swap(copies[i]);
  }

 private:
  static constexpr std::size_t kStripes = 16;
  struct alignas(64) Stripe {
    std::mutex mutex;
    std::shared_ptr<const T> value;
  };

  static std::size_t stripe_of_this_thread() {
    static std::atomic<std::size_t> threads{0};
    thread_local const std::size_t stripe = threads.fetch_add(1, std::memory_order_relaxed) % kStripes;
    return stripe;
  }

  mutable std::array<Stripe, kStripes> stripes_;
};

}  // namespace frontlux::detail
