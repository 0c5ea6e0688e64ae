#pragma once

namespace CLI {
class App;
}

namespace frontlux::app {

/// Adds `frontlux render` to the command line.
void add_render_command(CLI::App& app);

}  // namespace frontlux::app
