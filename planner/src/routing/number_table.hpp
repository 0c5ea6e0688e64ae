#pragma once

#include <cstddef>
#include <vector>

namespace frontlux::planner::detail {

/// A table of numbers, all the same at first.
class NumberTable {
 public:
  NumberTable() = default;
  NumberTable(std::size_t rows, std::size_t columns, double number = 0.0)
      : columns_(columns), numbers_(rows * columns, number) {}
  [[nodiscard]] double& operator()(std::size_t row, std::size_t column) {
    return numbers_[row * columns_ + column];
  }
  [[nodiscard]] double operator()(std::size_t row, std::size_t column) const {
    return numbers_[row * columns_ + column];
  }
  [[nodiscard]] const double* row(std::size_t row) const { return numbers_.data() + row * columns_; }

 private:
  std::size_t columns_ = 0;
  std::vector<double> numbers_;
};

}  // namespace frontlux::planner::detail
