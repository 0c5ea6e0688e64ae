#include "sensing/keyed_random.hpp"

#include <frontlux/sim/scan_messages.hpp>

#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

namespace frontlux::sim {

ScanMessages::ScanMessages(const MessageErrors& errors, std::uint64_t seed) : errors_(errors), seed_(seed) {
  if (!(errors.delay >= 0.0 && std::isfinite(errors.delay)))
    throw std::invalid_argument("messages: the delay is " + std::to_string(errors.delay) +
                                " s, but has to be finite and at least 0");
  if (!(errors.loss >= 0.0 && errors.loss <= 1.0))
    throw std::invalid_argument("messages: the loss is " + std::to_string(errors.loss) +
                                ", but has to lie between 0 and 1");
}

void ScanMessages::send(MovingRobots::Sensed scan) {
  constexpr std::uint64_t kLosses = 0x4D657373;  // a stream apart from those of sensors and poses
  if (random_of(seed_ + kLosses, sent_++).unit() >= errors_.loss) underway_.push_back(std::move(scan));
}

std::optional<double> ScanMessages::next_arrival() const {
  return underway_.empty() ? std::nullopt : std::optional(underway_.front().time + errors_.delay);
}

std::vector<MovingRobots::Sensed> ScanMessages::arrived(double time) {
  constexpr double kRounding = 1e-9;  // [s] 0.1 + 0.2 is more than 0.3
  std::vector<MovingRobots::Sensed> scans;
  for (; !underway_.empty() && underway_.front().time + errors_.delay <= time + kRounding;
       underway_.pop_front())
    scans.push_back(std::move(underway_.front()));
  return scans;
}

}  // namespace frontlux::sim
