#pragma once

#include "draw/picture.hpp"
#include "draw/run_map.hpp"

#include <frontlux/planner/recording.hpp>

#include <memory>
#include <string>

namespace frontlux::app {

/// A run's map seen obliquely from above, with the robots' paths, their starts and where they are, a key of
/// the heights and a scale. Shown are the faces of occupied voxels that look onto free space and towards the
/// viewer, so that walls on the near side hide nothing; of the paths, what they do not cover.
class MapView {
 public:
  /// Of the map in the picture, at most [px].
  struct Size {
    int width = 1600, height = 1200;
    int fine = 3;  ///< the map is drawn so many times as large, for soft edges
  };

  /// Fits what there is in the end, so that all pictures of a run have the same place and colours.
  /// @param all  the run at its end
  MapView(const planner::Recording& recording, const RunMap& all, const Size& most);

  [[nodiscard]] Picture draw(const RunMap& map, const std::string& title);

 private:
  struct State;
  std::shared_ptr<State> state_;
};

}  // namespace frontlux::app
