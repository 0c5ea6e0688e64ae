#pragma once

#include <filesystem>
#include <initializer_list>
#include <string_view>

namespace frontlux::app {

/// Checks the name of a file to be written, so that what would fail in the end fails before the work.
/// @param endings  of which the name has to have one: ".bt"
/// @throws BadInput, also if the file's folder is not there or may not be written to
void check_output(const std::filesystem::path& file, std::initializer_list<std::string_view> endings);

}  // namespace frontlux::app
