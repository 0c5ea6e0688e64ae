#pragma once

#include "goal/goal_query.hpp"

#include <frontlux/view_quality.hpp>

#include <optional>
#include <vector>

namespace frontlux::planner::detail {

/// What a rendered viewpoint is worth: of all it may see, or, if its robot does not see all around, of what
/// the best yaw shows.
/// @param containing  if given, only yaws that show this voxel count
[[nodiscard]] RenderedCell rate(const GoalQuery& query, const ViewQualityImage& image, std::size_t index,
                                const VoxelKey* containing = nullptr);

/// Whether one cell is the better goal: one of enough gain before those without, then by eq. 1, of equals the
/// one with the smallest key.
[[nodiscard]] bool better(const GoalQuery& query, const RenderedCell& a, const RenderedCell& b);

/// The best cell of an image, as `better` has it; nothing if no cell that is
/// far enough sees a target. With `refined` the best cells by the image are rendered again with all their
/// targets, and more of them, while that shows no gain, or not enough and the image promises more elsewhere.
/// @param containing  if given, a target that has to be in view
[[nodiscard]] std::optional<RenderedCell> best_cell(const GoalQuery& query, const ViewQualityImage& image,
                                                    const VoxelKey* containing = nullptr);

/// An image of some cells, and the random numbers that the options ask for.
[[nodiscard]] ViewQualityImage render_cells(const GoalQuery& query, std::span<const VoxelKey> cells,
                                            const ViewQualityOptions& rendering);

/// The options of a rendering that takes all targets.
[[nodiscard]] ViewQualityOptions all_targets(const GoalQuery& query);

}  // namespace frontlux::planner::detail
