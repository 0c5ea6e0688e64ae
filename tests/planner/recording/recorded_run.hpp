#pragma once

#include "planner/recording/random_recording.hpp"
#include "support/complaint.hpp"
#include "support/folder_test.hpp"
#include "support/random.hpp"

#include <frontlux/planner/recording.hpp>

namespace frontlux::test {

/// A recording in a folder of its own, and what it was made of.
class RecordedRun : public FolderTest {
 protected:
  [[nodiscard]] std::string bytes() const { return content_of(file_); }
  void save(const std::string& bytes) const { write("run.frontlux", bytes); }

  // What reading says when it refuses the file; empty if it does not.
  std::string complaint(const std::string& content) const {
    save(content);
    const std::string said =
        complaint_of<std::runtime_error>([&] { static_cast<void>(planner::read_recording(file_)); });
    EXPECT_TRUE(said.empty() || said.starts_with(file_.string() + ": ")) << said;
    return said;
  }
  void expect_refused(const std::string& content, const std::string& part) const {
    expect_parts(complaint(content), {part});
  }

  // A run in a file; returns its size after the head and after each step.
  std::vector<std::size_t> record(int steps, int size, bool end) {
    Random random(7);
    head_ = random_head(random, 2);
    steps_.clear();
    planner::RecordingWriter writer(file_, head_);
    std::vector<std::size_t> sizes = {bytes().size()};
    for (int i = 0; i < steps; ++i) {
      steps_.push_back(random_step(random, head_, static_cast<std::uint64_t>(i), size));
      writer.write(steps_.back());
      sizes.push_back(bytes().size());
    }
    if (end) writer.write_end("low_gain");
    return sizes;
  }

  void expect_steps(const planner::Recording& recording, std::size_t count) const {
    EXPECT_EQ(listed(recording.head), listed(head_));
    ASSERT_EQ(recording.steps.size(), count);
    for (std::size_t i = 0; i < count; ++i) ASSERT_EQ(listed(recording.steps[i]), listed(steps_[i])) << i;
  }

  std::filesystem::path file_ = folder_ / "run.frontlux";
  planner::RecordingHead head_;
  std::vector<planner::RecordedStep> steps_;
};

}  // namespace frontlux::test
