#include <frontlux/io/spelling.hpp>

#include <algorithm>
#include <cstddef>
#include <vector>

namespace frontlux::io {
namespace {

// How many letters have to be replaced, added, left out or swapped with their neighbour.
std::size_t distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> before, row(b.size() + 1), next(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) row[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    next[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      next[j] = std::min({row[j] + 1, next[j - 1] + 1, row[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1)});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
        next[j] = std::min(next[j], before[j - 2] + 1);
    }
    before = row;
    row.swap(next);
  }
  return row.back();
}

}  // namespace

std::optional<std::string> meant_by(std::string_view misspelt, std::span<const std::string> words) {
  constexpr std::size_t kLettersPerMistake = 4;
  const std::size_t mistakes = 1 + misspelt.size() / kLettersPerMistake;
  const auto far = [&](const std::string& word) { return distance(misspelt, word); };
  const auto nearest = std::ranges::min_element(words, {}, far);
  if (nearest != words.end() && far(*nearest) <= std::min(mistakes, misspelt.size() / 2)) return *nearest;
  const auto begins = [&](const std::string& word) { return word.starts_with(misspelt); };
  if (misspelt.empty() || std::ranges::count_if(words, begins) != 1) return std::nullopt;
  return *std::ranges::find_if(words, begins);
}

}  // namespace frontlux::io
