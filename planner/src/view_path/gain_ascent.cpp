#include "view_path/gain_ascent.hpp"

#include "motion/yaw.hpp"

#include <IpIpoptApplication.hpp>
#include <IpTNLP.hpp>
#include <algorithm>
#include <cmath>
#include <mutex>
#include <sstream>

namespace frontlux::planner {
namespace {

using Ipopt::Index, Ipopt::Number;

constexpr double kFirstStep = 0.1;  // [rad] largest turn of a stage's first step, before there is curvature
constexpr double kFlat = 1e-9;    // gradient per unit of gain under which a path counts as stationary [1/rad]
constexpr double kMargin = 1e-7;  // [rad] kept from the limits, which Ipopt meets to its own tolerance

// What is common to all stages: the gain, the number of evaluations, and the best yaws so far.
class Climb {
 public:
  Climb(const InformationGain& gain, std::span<const double> start, const YawLimits& limits)
      : gain_(gain),
        limits_(limits),
        best_(start.begin(), start.end()),
        shown_(best_),
        most_(gain.distinct(start)) {}

  [[nodiscard]] double evaluate(std::span<const double> yaws, double sharpness, std::span<double> gradient) {
    ++evaluations_;
    // What would be returned, to the last bit: without whole turns, the ends as they were given.
    for (std::size_t i = 1; i + 1 < yaws.size(); ++i) shown_[i] = detail::wrapped(yaws[i]);
    const std::uint64_t distinct = gain_.distinct(shown_);
    if (distinct >= most_ && limits_.allows(shown_)) {
      most_ = distinct;
      best_ = shown_;
    }
    return gain_.value(shown_, sharpness, gradient);
  }

  [[nodiscard]] const YawLimits& limits() const { return limits_; }
  [[nodiscard]] const std::vector<double>& best() const { return best_; }
  [[nodiscard]] int evaluations() const { return evaluations_; }

 private:
  const InformationGain& gain_;
  const YawLimits& limits_;
  std::vector<double> best_, shown_;  // [rad] inner ones in [-pi, pi]
  std::uint64_t most_;
  int evaluations_ = 0;
};

// One stage, as Ipopt sees it: x are the yaws between the ends, the objective is minus the gain.
class Stage : public Ipopt::TNLP {
 public:
  Stage(Climb& climb, std::vector<double> start, double sharpness, int max_evaluations)
      : climb_(climb),
        yaws_(std::move(start)),
        gradient_(yaws_.size()),
        sharpness_(sharpness),
        last_evaluation_(climb.evaluations() + max_evaluations) {
    // From here on yaws are continuous along the path, without jumps by a whole turn.
    for (std::size_t i = 1; i < yaws_.size(); ++i)
      yaws_[i] = yaws_[i - 1] + detail::turn(yaws_[i - 1], yaws_[i]);
    gain_ = climb_.evaluate(yaws_, sharpness_, gradient_);
    double steepest = 0.0;
    for (std::size_t i = 1; i + 1 < yaws_.size(); ++i) steepest = std::max(steepest, std::fabs(gradient_[i]));
    flat_ = !(steepest > kFlat * gain_);
    // Ipopt's first step is the gradient itself.
    scale_ = flat_ ? 1.0 : kFirstStep / steepest;
    for (std::size_t i = 0; i + 1 < yaws_.size(); ++i)
      if (std::isfinite(climb_.limits().step(i))) limited_.push_back(i);
  }

  [[nodiscard]] bool flat() const { return flat_; }
  [[nodiscard]] bool cut_short() const { return cut_short_; }
  [[nodiscard]] const std::vector<double>& yaws() const { return yaws_; }

  bool get_nlp_info(Index& n, Index& m, Index& jacobian, Index& hessian, IndexStyleEnum& style) override {
    n = count();
    m = static_cast<Index>(limited_.size());
    jacobian = 0;
    for (const std::size_t i : limited_) jacobian += static_cast<Index>(is_inner(i)) + is_inner(i + 1);
    hessian = 0;
    style = C_STYLE;
    return true;
  }

  bool get_bounds_info(Index n, Number* x_low, Number* x_high, Index, Number* g_low,
                       Number* g_high) override {
    constexpr double kNoBound = 1e19;  // for Ipopt the same as infinite
    std::fill_n(x_low, n, -kNoBound);
    std::fill_n(x_high, n, kNoBound);
    for (std::size_t r = 0; r < limited_.size(); ++r) {
      const double step = std::max(0.0, climb_.limits().step(limited_[r]) - kMargin);
      g_low[r] = -step;
      g_high[r] = step;
    }
    return true;
  }

  bool get_starting_point(Index n, bool, Number* x, bool, Number*, Number*, Index, bool, Number*) override {
    std::copy_n(yaws_.begin() + 1, n, x);
    return true;
  }

  bool eval_f(Index n, const Number* x, bool, Number& value) override {
    if (!move_to(n, x)) return false;
    value = -scale_ * gain_;
    return true;
  }

  bool eval_grad_f(Index n, const Number* x, bool, Number* gradient) override {
    if (!move_to(n, x)) return false;
    for (Index i = 0; i < n; ++i) gradient[i] = -scale_ * gradient_[static_cast<std::size_t>(i) + 1];
    return true;
  }

  bool eval_g(Index, const Number* x, bool, Index, Number* g) override {
    const auto yaw = [&](std::size_t i) { return is_inner(i) ? x[i - 1] : yaws_[i]; };
    for (std::size_t r = 0; r < limited_.size(); ++r) g[r] = yaw(limited_[r] + 1) - yaw(limited_[r]);
    return true;
  }

  bool eval_jac_g(Index, const Number*, bool, Index, Index, Index* row, Index* column,
                  Number* values) override {
    Index entry = 0;
    const auto add = [&](std::size_t r, std::size_t viewpoint, double value) {
      if (!is_inner(viewpoint)) return;
      if (values == nullptr) {
        row[entry] = static_cast<Index>(r);
        column[entry] = static_cast<Index>(viewpoint - 1);
      } else {
        values[entry] = value;
      }
      ++entry;
    };
    for (std::size_t r = 0; r < limited_.size(); ++r) {
      add(r, limited_[r], -1.0);
      add(r, limited_[r] + 1, 1.0);
    }
    return true;
  }

  bool intermediate_callback(Ipopt::AlgorithmMode, Index, Number, Number, Number, Number, Number, Number,
                             Number, Number, Index, const Ipopt::IpoptData*,
                             Ipopt::IpoptCalculatedQuantities*) override {
    return !cut_short_;
  }

  void finalize_solution(Ipopt::SolverReturn, Index, const Number*, const Number*, const Number*, Index,
                         const Number*, const Number*, Number, const Ipopt::IpoptData*,
                         Ipopt::IpoptCalculatedQuantities*) override {}

 private:
  [[nodiscard]] Index count() const { return static_cast<Index>(yaws_.size()) - 2; }
  [[nodiscard]] bool is_inner(std::size_t viewpoint) const {
    return viewpoint > 0 && viewpoint + 1 < yaws_.size();
  }

  // Ipopt calls for value and gradient separately, and sometimes twice. Its flag for a new x is unreliable.
  bool move_to(Index n, const Number* x) {
    if (std::equal(x, x + n, yaws_.begin() + 1)) return true;
    if (climb_.evaluations() >= last_evaluation_) {
      cut_short_ = true;
      return false;
    }
    if (!std::all_of(x, x + n, [](double yaw) { return std::isfinite(yaw); })) return false;
    std::copy_n(x, n, yaws_.begin() + 1);
    gain_ = climb_.evaluate(yaws_, sharpness_, gradient_);
    return true;
  }

  Climb& climb_;
  std::vector<double> yaws_;      // where value and gradient were evaluated last
  std::vector<double> gradient_;  // [1/rad]
  double gain_ = 0.0;
  double sharpness_;
  double scale_ = 1.0;
  int last_evaluation_;
  bool flat_ = false, cut_short_ = false;
  std::vector<std::size_t> limited_;  // viewpoints from which the turn to the next is limited
};

OptimizationEnd run(const Ipopt::SmartPtr<Stage>& stage, int max_iterations, bool limited) {
  if (stage->flat()) return OptimizationEnd::kConverged;
  const Ipopt::SmartPtr<Ipopt::IpoptApplication> solver = new Ipopt::IpoptApplication(false);
  const auto options = solver->Options();
  options->SetIntegerValue("print_level", 0);
  options->SetStringValue("sb", "yes");
  options->SetStringValue("hessian_approximation", "limited-memory");
  // One linear system an iteration instead of several small ones: half of the time Ipopt takes for itself.
  options->SetStringValue("limited_memory_aug_solver", "extended");
  options->SetStringValue("nlp_scaling_method", "none");
  options->SetStringValue("jac_c_constant", "yes");
  options->SetStringValue("jac_d_constant", "yes");
  options->SetIntegerValue("max_iter", max_iterations);
  options->SetIntegerValue("acceptable_iter", 3);
  options->SetNumericValue("tol", 1e-4);  // of a gradient scaled to kFirstStep
  options->SetNumericValue("acceptable_tol", 1e-3);
  options->SetNumericValue("bound_relax_factor", 0.0);
  if (limited) options->SetNumericValue("mu_init", 1e-3);
  // An empty stream: without it Ipopt reads ipopt.opt from wherever the program happens to run.
  std::istringstream no_file;
  if (solver->Initialize(no_file) != Ipopt::Solve_Succeeded) return OptimizationEnd::kSolverStopped;
  switch (solver->OptimizeTNLP(stage)) {
    case Ipopt::Solve_Succeeded:
    case Ipopt::Solved_To_Acceptable_Level:
      return OptimizationEnd::kConverged;
    case Ipopt::Maximum_Iterations_Exceeded:
      return OptimizationEnd::kEvaluationLimit;
    default:
      return stage->cut_short() ? OptimizationEnd::kEvaluationLimit : OptimizationEnd::kSolverStopped;
  }
}

}  // namespace

Ascent ascend(const InformationGain& gain, std::span<const double> start, const YawLimits& limits,
              std::span<const double> sharpness, int max_evaluations) {
  // Ipopt 3.11 numbers the states of its vectors by a static counter without a lock.
  static std::mutex one_at_a_time;
  const std::scoped_lock lock(one_at_a_time);

  Climb climb(gain, start, limits);
  Ascent ascent;
  for (std::size_t s = 0; s < sharpness.size(); ++s) {
    const int evaluations = (max_evaluations - climb.evaluations()) / static_cast<int>(sharpness.size() - s);
    ascent.end = OptimizationEnd::kEvaluationLimit;
    if (evaluations < 1) continue;
    const Ipopt::SmartPtr<Stage> stage = new Stage(climb, climb.best(), sharpness[s], evaluations);
    ascent.end = run(stage, evaluations, limits.limited());
  }
  ascent.yaws = climb.best();
  ascent.evaluations = climb.evaluations();
  return ascent;
}

}  // namespace frontlux::planner
