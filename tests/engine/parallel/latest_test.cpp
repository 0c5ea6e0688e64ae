#include "parallel/latest.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <latch>
#include <memory>
#include <thread>
#include <vector>

namespace frontlux::detail {
namespace {

TEST(Latest, NoReaderGoesBackInTimeNorSeesWhatIsGone) {
  struct Value {
    explicit Value(int n) : number(n) {}
    ~Value() { number = -1; }
    int number;
  };
  constexpr int kValues = 2000;
  Latest<Value> latest(std::make_shared<const Value>(0));
  const auto read_to_the_end = [&](const auto& read) {
    bool in_order = true;
    for (int before = 0; before < kValues;) {
      const int now = read();
      in_order = in_order && now >= before;
      before = now;
    }
    EXPECT_TRUE(in_order);
  };
  std::vector<std::thread> readers;
  for (int i = 0; i < 2; ++i) {
    readers.emplace_back([&] {
      read_to_the_end([&] { return latest.with([](const Value& value) { return value.number; }); });
    });
    readers.emplace_back([&] { read_to_the_end([&] { return latest.get()->number; }); });
  }
  for (int n = 1; n <= kValues; ++n) latest.set(std::make_shared<const Value>(n));
  for (std::thread& reader : readers) reader.join();
}

TEST(Latest, MoreReadersThanLocksWaitForEachOther) {
  constexpr int kReaders = 40;
  const Latest<int> latest(std::make_shared<const int>(7));
  std::latch all(kReaders);
  std::atomic<int> sum{0};
  std::vector<std::thread> readers;
  for (int i = 0; i < kReaders; ++i)
    readers.emplace_back([&] {
      all.arrive_and_wait();
      for (int n = 0; n < 20; ++n)
        sum += latest.with([](int value) {
          std::this_thread::yield();
          return value;
        });
    });
  for (std::thread& reader : readers) reader.join();
  EXPECT_EQ(sum, 7 * 20 * kReaders);
}

TEST(Latest, KeepsWhatReadersGot) {
  Latest<int> latest(std::make_shared<const int>(1));
  const auto kept = latest.get();
  latest.set(std::make_shared<const int>(2));
  EXPECT_EQ(*kept, 1);
  EXPECT_EQ(latest.with([](int value) { return value; }), 2);
}

}  // namespace
}  // namespace frontlux::detail
