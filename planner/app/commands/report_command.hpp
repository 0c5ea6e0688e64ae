#pragma once

namespace CLI {
class App;
}

namespace frontlux::app {

/// Adds `frontlux report` to the command line.
void add_report_command(CLI::App& app);

}  // namespace frontlux::app
