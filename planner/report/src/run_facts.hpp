#pragma once

#include <frontlux/report/report.hpp>

#include <string>

namespace frontlux::report::detail {

/// All of a run but voxels, images and paths, as a JSON object: what it was, and the numbers of each step.
[[nodiscard]] std::string run_facts(const ReportedRun& run, const std::string& version);

}  // namespace frontlux::report::detail
