#pragma once

#include <cstddef>
#include <vector>

namespace frontlux::planner::detail {

/// A table of numbers, zero at first.
class NumberTable {
 public:
  NumberTable() = default;
  NumberTable(std::size_t rows, std::size_t columns) : columns_(columns), numbers_(rows * columns) {}
  [[nodiscard]] double& operator()(std::size_t row, std::size_t column) {
    return numbers_[row * columns_ + column];
  }
  [[nodiscard]] double operator()(std::size_t row, std::size_t column) const {
    return numbers_[row * columns_ + column];
  }

 private:
  std::size_t columns_ = 0;
  std::vector<double> numbers_;
};

}  // namespace frontlux::planner::detail
