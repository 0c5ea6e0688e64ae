#pragma once

#include <CLI/CLI.hpp>

#include <filesystem>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace frontlux::app {

/// How --help shows options: "--range METRES   Longest distance to a voxel's centre [10]", or "(required)".
class HelpFormatter : public CLI::Formatter {
 public:
  /// Shows an option in --help-all only.
  void hide(const CLI::Option* option) { rare_.insert(option); }

  std::string make_option_opts(const CLI::Option* option) const override;
  std::string make_option_desc(const CLI::Option* option) const override;
  std::string make_option_usage(const CLI::Option* option) const override;
  std::string make_group(std::string group, bool positional,
                         std::vector<const CLI::Option*> options) const override;
  std::string make_help(const CLI::App* app, std::string name, CLI::AppFormatMode mode) const override;

 private:
  std::set<const CLI::Option*> rare_;
  mutable bool all_ = false;  // while it makes a help
};

/// Whether what --help shows for an option's value stands for a file, or for a folder.
[[nodiscard]] bool is_file(std::string_view type);
[[nodiscard]] bool is_folder(std::string_view type);
/// @param option  for messages
/// @throws BadInput if a word is empty that is to name a file or a folder
void check_name(const std::string& option, std::string_view word, std::string_view type);

/// The names of an app's options as they are written, "--seed"; short ones too if `with_short`.
[[nodiscard]] std::vector<std::string> option_names(const CLI::App& app, bool with_short = false);

/// Writes what --help-all says as man pages, man1/frontlux.1 and man1/frontlux-COMMAND.1, and a file that
/// lets bash complete commands, options and their values, completions/frontlux.
/// @param folder  is created if it is missing
/// @throws BadInput, if it cannot be written
void write_manual(const CLI::App& app, const std::filesystem::path& folder);

}  // namespace frontlux::app
