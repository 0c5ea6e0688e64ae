#include "read_value.hpp"

#include "text.hpp"

#include <frontlux/io/pose_file.hpp>

#include <cmath>

namespace frontlux::app {
namespace {

template <class Number>
std::optional<Number> number_in(std::string_view word) {
  if (word.size() > 1 && word[0] == '+' && word[1] != '-') word.remove_prefix(1);  // from_chars knows no plus
  const auto number = number_from<Number>(word);
  if constexpr (std::is_floating_point_v<Number>)
    if (number && !std::isfinite(*number)) return std::nullopt;
  return number;
}

std::string describe(const Range<double>& range) {
  const bool bounded = range.high < std::numeric_limits<double>::max();
  if (range.low == kAnyNumber.low && !bounded) return "a finite number";
  if (range.low == kAboveZero.low)
    return bounded ? "a number above 0, at most " + to_text(range.high) : "a number above 0";
  return bounded ? "a number from " + to_text(range.low) + " to " + to_text(range.high)
                 : "a number of at least " + to_text(range.low);
}

template <class Number>
std::string describe(const Range<Number>& range) {
  return "a whole number from " + std::to_string(range.low) + " to " + std::to_string(range.high);
}

template <class Number>
void read_number(std::string_view word, Number& number, const Range<Number>& range) {
  const auto found = number_in<Number>(word);
  if (!found || *found < range.low || *found > range.high)
    throw BadInput(quote(word) + " is not " + describe(range));
  number = *found;
}

}  // namespace

void read(std::string_view word, double& number, const Range<double>& range) {
  read_number(word, number, range);
}
void read(std::string_view word, int& number, const Range<int>& range) { read_number(word, number, range); }
void read(std::string_view word, std::uint64_t& number, const Range<std::uint64_t>& range) {
  read_number(word, number, range);
}

void read(std::string_view word, Eigen::Vector3f& point) {
  const auto numbers = numbers_in(word);
  if (!numbers || numbers->size() != 3)
    throw BadInput(quote(word) +
                   " is not three finite numbers; write x,y,z without blanks, as in 1.5,-2,0.4");
  point = Eigen::Vector3d((*numbers)[0], (*numbers)[1], (*numbers)[2]).cast<float>();
  if (!point.allFinite()) throw BadInput(quote(word) + " is too large: no map reaches as far");
}

void read(std::string_view word, Eigen::AlignedBox3d& box) {
  const auto numbers = numbers_in(word);
  if (!numbers || numbers->size() != 6)
    throw BadInput(quote(word) +
                   " is not six finite numbers; give the lowest and the highest corner, as in -5,-5,0,5,5,3");
  const auto corner = Eigen::Map<const Eigen::Matrix<double, 3, 2>>(numbers->data());
  box = {corner.col(0), corner.col(1)};
}

std::optional<std::vector<double>> numbers_in(std::string_view word) {
  std::vector<double> numbers;
  for (std::string_view rest = word;; rest.remove_prefix(rest.find(',') + 1)) {
    const auto number = number_in<double>(rest.substr(0, rest.find(',')));
    if (!number) return std::nullopt;
    numbers.push_back(*number);
    if (rest.find(',') == std::string_view::npos) return numbers;
  }
}

void check_yaw(std::string_view word, double yaw) {
  if (!io::is_within_a_turn(yaw))
    throw BadInput(quote(word) + " has a yaw of more than a turn; give it in radians, from -3.142 to 3.142");
}

}  // namespace frontlux::app
