#pragma once

#include <frontlux/export.hpp>

#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace frontlux::io {

/// The word that was probably meant by a misspelt one: with one letter in four wrong, missing, doubled or
/// swapped at most, or the only one that begins so. Nothing if there is none such.
[[nodiscard]] FRONTLUX_EXPORT std::optional<std::string> meant_by(std::string_view misspelt,
                                                                  std::span<const std::string> words);

}  // namespace frontlux::io
