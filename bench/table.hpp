#pragma once

#include <array>
#include <cstddef>
#include <cstdio>
#include <string>
#include <vector>

namespace frontlux::bench {

/// A table of text. The first column is aligned to the left, the others to the right.
class Table {
 public:
  /// Adds columns after those there are, with a common title, which may be empty.
  void add_columns(const std::string& title, const std::vector<std::string>& names);

  /// Adds a row. @pre as many cells as there are columns, or fewer: the others are empty
  void add_row(std::vector<std::string> cells);

  /// Adds a line between rows.
  void add_line() { rows_.emplace_back(); }

  /// With spaces, and a bar before each group of columns but the first.
  [[nodiscard]] std::string text() const;

  /// As a table of Markdown, without titles and lines.
  [[nodiscard]] std::string markdown() const;

 private:
  struct Group {
    std::string title;
    std::size_t begin;
  };
  std::vector<Group> groups_;
  std::vector<std::string> names_;
  std::vector<std::vector<std::string>> rows_;  // empty: a line
};

/// Numbers and texts by a pattern of printf.
template <class... Values>
[[nodiscard]] std::string format(const char* pattern, Values... values) {
  std::array<char, 512> text{};
  std::snprintf(text.data(), text.size(), pattern, values...);
  return text.data();
}

/// Three digits, however large.
[[nodiscard]] std::string digits(double value);

/// A fraction below 1 never reads as 100 %.
[[nodiscard]] std::string percent(double fraction);

/// "1 thread", "2 threads"
[[nodiscard]] std::string thread_count(int threads);

/// The mean of the two in the middle if their number is even. @pre there are values
[[nodiscard]] double median(std::vector<double> values);

}  // namespace frontlux::bench
