#pragma once

namespace CLI {
class App;
}

namespace frontlux::app {

/// Each adds one subcommand of `frontlux` to the command line.
void add_info_command(CLI::App& app);
void add_cast_command(CLI::App& app);
void add_world_command(CLI::App& app);
void add_scan_command(CLI::App& app);
void add_map_command(CLI::App& app);
void add_plan_command(CLI::App& app);
void add_render_command(CLI::App& app);
void add_explore_command(CLI::App& app);
void add_report_command(CLI::App& app);

}  // namespace frontlux::app
