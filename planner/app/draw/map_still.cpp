#include "draw/map_view.hpp"
#include "draw/stills.hpp"

namespace frontlux::app {

Picture draw_final_map(const planner::Recording& recording, const std::string& name) {
  RunMap map(recording);
  map.go_to(map.end());
  return MapView(recording, map, {}).draw(map, map.title(name));
}

}  // namespace frontlux::app
