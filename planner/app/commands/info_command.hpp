#pragma once

namespace CLI {
class App;
}

namespace frontlux::app {

/// Adds `frontlux info` to the command line.
void add_info_command(CLI::App& app);

}  // namespace frontlux::app
