#pragma once

namespace CLI {
class App;
}

namespace frontlux::app {

/// Adds `frontlux scan` to the command line.
void add_scan_command(CLI::App& app);

}  // namespace frontlux::app
