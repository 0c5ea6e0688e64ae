#pragma once

namespace CLI {
class App;
}

namespace frontlux::app {

/// Adds `frontlux map` to the command line.
void add_map_command(CLI::App& app);

}  // namespace frontlux::app
