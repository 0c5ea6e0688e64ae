#pragma once

#include "paths/ablation.hpp"

#include <ostream>
#include <span>

namespace frontlux::bench {

/// The page: what was measured, the table of methods and maps, what each path costs, what follows.
void print_ablation(std::span<const MapTrial> maps, const PathTrial& large, std::ostream& out);

}  // namespace frontlux::bench
