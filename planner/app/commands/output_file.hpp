#pragma once

#include <filesystem>
#include <initializer_list>
#include <span>
#include <string>
#include <string_view>

namespace frontlux::app {

/// Checks that a file can be written, so that what would fail in the end fails before the work. What is there
/// has to be a file that may be written to, or a link to one, which the new file replaces.
/// @param option  that asks for the file, in messages: "--output"
/// @throws BadInput
void check_writable(const std::string& option, const std::filesystem::path& file);

/// The same for the file that --output names.
/// @param endings  of which the name has to have one: ".bt"
/// @param inputs   what is read, which the file may not replace
void check_output(const std::filesystem::path& file, std::initializer_list<std::string_view> endings,
                  std::span<const std::string> inputs);

}  // namespace frontlux::app
