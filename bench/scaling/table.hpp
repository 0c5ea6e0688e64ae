#pragma once

#include "report.hpp"
#include "scaling/sweep.hpp"

#include <ostream>
#include <span>

namespace frontlux::bench {

/// One line per point and number of threads: rates, speed-up over castRay and agreement; then one line per
/// map of the axis `size`: memory and build time per known voxel.
void print_scaling_table(std::span<const Point> points, const Recorder& recorder, std::ostream& out);

}  // namespace frontlux::bench
