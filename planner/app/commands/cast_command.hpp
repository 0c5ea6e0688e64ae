#pragma once

namespace CLI {
class App;
}

namespace frontlux::app {

/// Adds `frontlux cast` to the command line.
void add_cast_command(CLI::App& app);

}  // namespace frontlux::app
