#pragma once

#include "goal/goal_query.hpp"

#include <frontlux/view_quality.hpp>

#include <optional>

namespace frontlux::planner::detail {

/// Gain and quality of a rendered viewpoint: of all that it may see or, if its robot does not see all around,
/// of what it sees at the best yaw.
/// @param containing  if given, only yaws that show this voxel count
[[nodiscard]] RenderedCell rate(const GoalQuery& query, const ViewQualityImage& image, std::size_t index,
                                const VoxelKey* containing = nullptr);

/// Whether one cell is the better goal: first by whether its gain is enough, then by eq. 1, then by key.
[[nodiscard]] bool better(const GoalQuery& query, const RenderedCell& a, const RenderedCell& b);

/// The best cell of an image by `better`; nothing if no cell that is far enough sees a target. With `refined`
/// the best cells by the image are rendered again with all their targets. More of them follow while none has
/// a gain, or while none has enough and the image expects enough elsewhere.
/// @param containing  if given, a target that has to be in view
[[nodiscard]] std::optional<RenderedCell> best_cell(const GoalQuery& query, const ViewQualityImage& image,
                                                    const VoxelKey* containing = nullptr);

/// An image of some cells.
[[nodiscard]] ViewQualityImage render_cells(const GoalQuery& query, std::span<const VoxelKey> cells,
                                            const ViewQualityOptions& rendering);

/// The robot's rendering options, with all targets instead of samples.
[[nodiscard]] ViewQualityOptions all_targets(const GoalQuery& query);

}  // namespace frontlux::planner::detail
