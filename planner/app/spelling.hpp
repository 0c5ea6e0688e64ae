#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace frontlux::app {

/// The word that was probably meant by a misspelt one: with one letter in four wrong, missing, doubled or
/// swapped at most, or the only one that begins so. Nothing if there is none such.
[[nodiscard]] std::optional<std::string> meant_by(std::string_view misspelt,
                                                  std::span<const std::string> words);

}  // namespace frontlux::app
