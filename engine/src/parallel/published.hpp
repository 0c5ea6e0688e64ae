#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <memory>
#include <mutex>

namespace frontlux::detail {

/// A value that readers take snapshots of while a writer replaces it. Nobody waits longer than a pointer
/// takes to copy. Each stripe has its own lock and its own reference count, so that threads that cast ray by
/// ray do not pull the same cache line to and fro.
template <class T>
class Published {
 public:
  using Snapshot = std::shared_ptr<const T>;

  explicit Published(Snapshot value) { replace(std::move(value)); }

  [[nodiscard]] Snapshot snapshot() const {
    Stripe& stripe = stripes_[stripe_of_this_thread()];
    const std::lock_guard lock(stripe.mutex);
    return stripe.value;
  }

  void replace(Snapshot value) {
    for (Stripe& stripe : stripes_) {
      // A second owner with a count of its own keeps the first alive.
      Snapshot copy(value.get(), [value](const T*) {});
      const std::lock_guard lock(stripe.mutex);
      stripe.value.swap(copy);
    }
  }

 private:
  static constexpr std::size_t kStripes = 16;
  struct alignas(64) Stripe {
    std::mutex mutex;
    Snapshot value;
  };

  static std::size_t stripe_of_this_thread() {
    static std::atomic<std::size_t> threads{0};
    thread_local const std::size_t stripe = threads.fetch_add(1, std::memory_order_relaxed) % kStripes;
    return stripe;
  }

  mutable std::array<Stripe, kStripes> stripes_;
};

}  // namespace frontlux::detail
