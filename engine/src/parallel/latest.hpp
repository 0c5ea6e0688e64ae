#pragma once

#include <array>
#include <atomic>
#include <chrono>
#include <cstddef>
#include <memory>
#include <mutex>
#include <thread>
#include <utility>

namespace frontlux::detail {

/// A lock for what takes less time than to put a thread to sleep. A thread that waits longer sleeps all the
/// same, so that one of less priority, which holds the lock, can go on. To unlock takes no atomic exchange.
class ShortLock {
 public:
  [[nodiscard]] bool try_lock() { return !taken_.exchange(true, std::memory_order_acquire); }
  void lock() {
    for (int tries = 0; !try_lock(); ++tries) wait(tries);
  }
  void unlock() { taken_.store(false, std::memory_order_release); }

  /// Before the next try.
  static void wait(int tries) {
    constexpr int kSoon = 100;
    constexpr std::chrono::microseconds kPause{50};
    if (tries < kSoon)
      std::this_thread::yield();
    else
      std::this_thread::sleep_for(kPause);
  }

 private:
  std::atomic<bool> taken_{false};
};

/// The latest of the values that a writer sets. Readers keep the one that they got for as long as they need
/// it. Each stripe has its own lock and its own reference count, so that threads that cast single rays do not
/// compete for one cache line; a reader takes another one where its own is in use.
template <class T>
class Latest {
 public:
  explicit Latest(std::shared_ptr<const T> value) { set(std::move(value)); }

  [[nodiscard]] std::shared_ptr<const T> get() const {
    Stripe& stripe = take_one();
    const std::lock_guard lock(stripe.lock, std::adopt_lock);
    return stripe.value;
  }

  /// What `use` makes of it: to count references takes longer than a short ray. A writer waits for it, so
  /// `use` has to be short, and must set nothing.
  template <class Use>
  [[nodiscard]] auto with(const Use& use) const {
    Stripe& stripe = take_one();
    const std::lock_guard lock(stripe.lock, std::adopt_lock);
    return use(*stripe.value);
  }

  void set(std::shared_ptr<const T> value) {
    // Second owners with counts of their own keep the first alive. All are made before any is seen, since
    // there may be no memory for one.
    std::array<std::shared_ptr<const T>, kStripes> copies;
    for (auto& copy : copies) copy = std::shared_ptr<const T>(value.get(), [value](const T*) {});
    // All at once: who hears of the new value from another thread gets no older one.
    std::array<std::unique_lock<ShortLock>, kStripes> locks;
    for (std::size_t i = 0; i < kStripes; ++i) locks[i] = std::unique_lock(stripes_[i].lock);
    for (std::size_t i = 0; i < kStripes; ++i) stripes_[i].value.swap(copies[i]);
  }

 private:
  static constexpr std::size_t kStripes = 16;
  struct alignas(64) Stripe {
    ShortLock lock;
    std::shared_ptr<const T> value;
  };

  // Locked.
  [[nodiscard]] Stripe& take_one() const {
    const std::size_t own = stripe_of_this_thread();
    for (int tries = 0;; ++tries) {
      for (std::size_t i = 0; i < kStripes; ++i)
        if (Stripe& stripe = stripes_[(own + i) % kStripes]; stripe.lock.try_lock()) return stripe;
      ShortLock::wait(tries);
    }
  }

  static std::size_t stripe_of_this_thread() {
    static std::atomic<std::size_t> threads{0};
    thread_local const std::size_t stripe = threads.fetch_add(1, std::memory_order_relaxed) % kStripes;
    return stripe;
  }

  mutable std::array<Stripe, kStripes> stripes_;
};

}  // namespace frontlux::detail
