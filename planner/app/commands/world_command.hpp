#pragma once

namespace CLI {
class App;
}

namespace frontlux::app {

/// Adds `frontlux world` to the command line.
void add_world_command(CLI::App& app);

}  // namespace frontlux::app
