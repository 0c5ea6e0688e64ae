#include "paths/methods.hpp"

namespace frontlux::bench {

std::vector<YawMethod> yaw_methods() {
  using planner::GainMode, planner::PathOptimizerOptions, planner::YawStart;
  const auto with = [](YawStart start, bool ascend, GainMode mode) {
    PathOptimizerOptions options;
    options.start = start;
    options.ascend = ascend;
    options.gain.mode = mode;
    if (start != YawStart::kGreedy) options.max_evaluations = 60;
    return options;
  };
  auto fine = with(YawStart::kGreedy, false, GainMode::kOr);
  fine.yaw_bins = 60;
  return {{"tangent", std::nullopt},
          {"tangent, Ipopt, SUM (paper)", planner::paper_path_options()},
          {"tangent, Ipopt, OR", with(YawStart::kTangent, true, GainMode::kOr)},
          {"best of 24 bins", with(YawStart::kBestBins, false, GainMode::kSum)},
          {"best of 24 bins, Ipopt, SUM", with(YawStart::kBestBins, true, GainMode::kSum)},
          {"best of 24 bins, Ipopt, OR", with(YawStart::kBestBins, true, GainMode::kOr)},
          {"greedy among 24 bins", with(YawStart::kGreedy, false, GainMode::kOr)},
          {"greedy among 60 bins", fine},
          {"greedy among 24 bins, Ipopt, SUM", with(YawStart::kGreedy, true, GainMode::kSum)},
          {"greedy among 24 bins, Ipopt, OR (default)", with(YawStart::kGreedy, true, GainMode::kOr)}};
}

}  // namespace frontlux::bench
