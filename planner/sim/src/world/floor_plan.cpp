#include "world/floor_plan.hpp"

#include <algorithm>

namespace frontlux::sim {

std::optional<Rect> FloorPlan::place(LayoutRandom& random, int along_x, int along_y) {
  const Rect inner = area_.grown(-kPassage);
  if (inner.x.length() < along_x || inner.y.length() < along_y) return std::nullopt;
  for (int draw = 0; draw < 300; ++draw) {
    const int x = random.whole(inner.x.from, inner.x.to - along_x);
    const int y = random.whole(inner.y.from, inner.y.to - along_y);
    const Rect rect{{x, x + along_x}, {y, y + along_y}};
    if (std::none_of(taken_.begin(), taken_.end(), [with_passage = rect.grown(kPassage)](const Rect& other) {
          return with_passage.overlaps(other);
        })) {
      taken_.push_back(rect);
      return rect;
    }
  }
  return std::nullopt;
}

}  // namespace frontlux::sim
