#pragma once

#include <frontlux/sim/moving_robots.hpp>

#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

namespace frontlux::sim {

/// How scans get from the robots to the map that they share: at once, all of them, by default.
struct MessageErrors {
  double delay = 0.0;  ///< [s] after which a scan is there
  double loss = 0.0;   ///< the part of scans that never is, 0 to 1
};

/// Scans on their way to the map.
class ScanMessages {
 public:
  /// @param seed  of the losses
  /// @throws std::invalid_argument if the delay is negative or not finite, or the loss is no part
  ScanMessages(const MessageErrors& errors, std::uint64_t seed);

  /// A scan sets out, when it is taken. @pre no earlier than the one before
  void send(MovingRobots::Sensed scan);
  /// Those that have arrived by a time [s], in the order in which they set out, and no others since the last
  /// call.
  [[nodiscard]] std::vector<MovingRobots::Sensed> arrived(double time);
  /// [s] When the next one of those that are under way arrives; nothing if there is none.
  [[nodiscard]] std::optional<double> next_arrival() const;

 private:
  MessageErrors errors_;
  std::uint64_t seed_;
  std::uint64_t sent_ = 0;
  std::deque<MovingRobots::Sensed> underway_;
};

}  // namespace frontlux::sim
