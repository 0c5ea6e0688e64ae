#pragma once

#include <frontlux/caster_kind.hpp>

#include <CLI/CLI.hpp>

#include <string>
#include <vector>

namespace frontlux::app {

/// Adds `--caster NAME` to a command.
inline void add_caster_option(CLI::App& command, CasterKind& caster, const std::string& description) {
  std::vector<std::string> names;
  for (const auto& [name, kind] : kCasterNames) names.emplace_back(name);
  const auto parse = [&caster](const CLI::results_t& words) {
    const auto kind = caster_kind(words.front());
    caster = kind.value_or(caster);
    return kind.has_value();
  };
  command.add_option("--caster", parse, description)
      ->check(CLI::IsMember(names))
      ->default_str(std::string(name_of(caster)));
}

}  // namespace frontlux::app
