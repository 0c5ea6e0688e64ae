#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

namespace frontlux::app {

/// About how long a run will go on, by how it went in its last part. What comes last in a run is often slower
/// than what came before, so this is rather too little than too much.
class RunForecast {
 public:
  /// What grows until a run ends: the mapped part of the observable space, the clock [s], steps.
  using Quantities = std::array<double, 3>;

  /// @param ends  a run ends as soon as one of its quantities is so large; infinite: never
  explicit RunForecast(const Quantities& ends) : ends_(ends) {}

  /// @param seconds  since the run began or was resumed, never less than before
  void note(double seconds, const Quantities& now) { noted_.push_back({seconds, now}); }

  /// [s]; nothing as long as that cannot be told.
  [[nodiscard]] std::optional<double> left() const;

 private:
  struct Noted {
    double seconds;
    Quantities quantities;
  };
  Quantities ends_;
  std::vector<Noted> noted_;
};

/// "about 40 s", "about 3 min".
[[nodiscard]] std::string about(double seconds);

}  // namespace frontlux::app
