#pragma once

#include <array>
#include <cstdint>
#include <string_view>
#include <utility>

namespace frontlux::planner {

/// A part of the search for tours that can be left out, to see what it adds.
enum class TourPart : std::uint8_t {
  kNone,
  kZones,       ///< far clusters of a zone make one stop; without, each makes its own
  kJoining,     ///< the next clusters are seen from as few viewpoints as can be; without, each from its own
  kArrival,     ///< the next stops are in the order of early arrival; without, in that of the shortest tour
  kRefinement,  ///< viewpoints of the next few stops are chosen together; without, each sees most by itself
  kTours,  ///< who goes where in what order; without, each robot goes to the stop that it reaches soonest
           ///< of those to which no other one is going
};
/// As options and files call them.
inline constexpr std::array<std::pair<std::string_view, TourPart>, 6> kTourPartNames = {
    {{"nothing", TourPart::kNone},
     {"zones", TourPart::kZones},
     {"joining", TourPart::kJoining},
     {"arrival", TourPart::kArrival},
     {"refinement", TourPart::kRefinement},
     {"tours", TourPart::kTours}}};

}  // namespace frontlux::planner
