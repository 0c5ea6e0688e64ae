#include "table.hpp"

#include <algorithm>
#include <span>

namespace frontlux::bench {
namespace {

constexpr std::size_t kGap = 2;  // between columns

std::string padded(const std::string& text, std::size_t width) {
  return std::string(width - std::min(width, text.size()), ' ') + text;
}

}  // namespace

void Table::add_columns(const std::string& title, const std::vector<std::string>& names) {
  groups_.push_back({title, names_.size()});
  names_.insert(names_.end(), names.begin(), names.end());
}

void Table::add_row(std::vector<std::string> cells) {
  cells.resize(names_.size());
  rows_.push_back(std::move(cells));
}

std::string Table::text() const {
  std::vector<std::size_t> widths(names_.size());
  for (std::size_t c = 0; c < widths.size(); ++c) {
    widths[c] = names_[c].size();
    for (const auto& row : rows_)
      if (!row.empty()) widths[c] = std::max(widths[c], row[c].size());
    if (c > 0) widths[c] += kGap;
  }
  std::string titles;
  for (std::size_t g = 0; g < groups_.size(); ++g) {
    const auto& [title, begin] = groups_[g];
    const std::size_t end = g + 1 < groups_.size() ? groups_[g + 1].begin : names_.size();
    std::size_t width = 0;
    for (std::size_t c = begin; c < end; ++c) width += widths[c];
    if (width < title.size() + kGap && !title.empty()) {
      widths[begin] += title.size() + kGap - width;
      width = title.size() + kGap;
    }
    const std::size_t left = (width - title.size() + 1) / 2;
    titles += (g > 0 ? " |" : "") + padded(title, left + title.size()) +
              std::string(width - left - title.size(), ' ');
  }
  const auto line_of = [&](const std::vector<std::string>& cells) {
    std::string line = cells[0] + std::string(widths[0] - cells[0].size(), ' ');
    for (std::size_t c = 1; c < cells.size(); ++c) {
      if (std::ranges::find(groups_, c, &Group::begin) != groups_.end()) line += " |";
      line += padded(cells[c], widths[c]);
    }
    return line.substr(0, line.find_last_not_of(' ') + 1) + '\n';
  };
  const std::string heads = line_of(names_), rule(titles.size(), '-');
  std::string text = titles.find_first_not_of(" |") == std::string::npos ? "" : titles + '\n';
  text += heads + rule + '\n';
  for (const auto& row : rows_) text += row.empty() ? rule + '\n' : line_of(row);
  return text;
}

std::string Table::markdown() const {
  const auto line_of = [](std::span<const std::string> cells) {
    std::string line = "|";
    for (const std::string& cell : cells) line += " " + cell + " |";
    return line + '\n';
  };
  std::string text = line_of(names_) + "|---|";
  for (std::size_t c = 1; c < names_.size(); ++c) text += "---:|";
  text += '\n';
  for (const auto& row : rows_) text += line_of(row);
  return text;
}

std::string digits(double value) {
  return format(value < 9.995 ? "%.2f" : value < 99.95 ? "%.1f" : "%.0f", value);
}

std::string percent(double fraction) {
  return fraction == 1.0 ? "100 %" : format("%.2f %%", std::min(100 * fraction, 99.99));
}

std::string thread_count(int threads) {
  return std::to_string(threads) + (threads == 1 ? " thread" : " threads");
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const std::size_t half = values.size() / 2;
  return values.size() % 2 == 1 ? values[half] : (values[half - 1] + values[half]) / 2;
}

}  // namespace frontlux::bench
