#pragma once

namespace CLI {
class App;
}

namespace frontlux::app {

void add_explore_command(CLI::App& app);

}  // namespace frontlux::app
