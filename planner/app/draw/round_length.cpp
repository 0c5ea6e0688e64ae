#include "draw/round_length.hpp"

#include <array>
#include <charconv>
#include <cmath>

namespace frontlux::app {

double round_length(double most) {
  const double power = std::pow(10.0, std::floor(std::log10(most)));
  for (const double factor : {5.0, 2.0})
    if (power * factor <= most) return power * factor;
  return power;
}

std::string short_number(double number) {
  std::array<char, 32> buffer{};
  char *const begin = buffer.data(), *const end = begin + buffer.size();
  const bool whole = number >= 1000.0 && number < 1e7;
  const auto written = whole ? std::to_chars(begin, end, std::llround(number))
                             : std::to_chars(begin, end, number, std::chars_format::general, 3);
  return {begin, written.ptr};
}

}  // namespace frontlux::app
