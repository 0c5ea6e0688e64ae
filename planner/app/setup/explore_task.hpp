#pragma once

#include "command.hpp"
#include "setup/explore_options.hpp"

#include <string>

namespace frontlux::app {

struct ExploreSetup;

/// Reads a task's file into options that are the defaults so far.
/// @param read_option  of the command, for the further options of a task
/// @throws BadInput naming the file, the member, its value and what to do
void apply_task(const std::string& file, const Command::ReadOption& read_option, ExploreOptions& options);

/// The whole task of a run as a JSON object: the same run again if it is saved to a file.
[[nodiscard]] std::string task_text(const ExploreOptions& options, const ExploreSetup& setup);

}  // namespace frontlux::app
