#pragma once

namespace CLI {
class App;
}

namespace frontlux::app {

/// Adds `frontlux plan` to the command line.
void add_plan_command(CLI::App& app);

}  // namespace frontlux::app
