#include "planner/recording/recorded_run.hpp"
#include "recording/packed_record.hpp"
#include "recording/recording_format.hpp"
#include "support/input_test.hpp"
#include "support/maps.hpp"

#include <sys/resource.h>

#include <csignal>
#include <cstring>

namespace frontlux::planner {
namespace {

using test::complaint_of;
using test::Random;
using RecordingDamageTest = test::RecordedRun;

TEST_F(RecordingDamageTest, EveryTruncationIsAPrefix) {
  const auto sizes = record(3, 6, true);
  const std::string whole = bytes();
  for (std::size_t length = 0; length < whole.size(); ++length) {
    SCOPED_TRACE(length);
    const std::string part = whole.substr(0, length);
    if (length < sizes[0]) {
      EXPECT_NE(complaint(part), "");
      continue;
    }
    save(part);
    const Recording recording = read_recording(file_);
    std::size_t count = 0;
    while (count + 1 < sizes.size() && sizes[count + 1] <= length) ++count;
    expect_steps(recording, count);
    EXPECT_EQ(recording.bytes, sizes[count]);
    EXPECT_EQ(recording.truncated, length != sizes[count]);
    EXPECT_EQ(recording.end, std::nullopt);
  }
}

// What draws it would be far out of its numbers.
TEST_F(RecordingDamageTest, PosesAreOnThisPlanet) {
  const auto head_size = record(1, 4, true).front();
  const std::string head = bytes().substr(0, head_size);
  RecordedStep step = steps_[0];
  step.step.robots[0].planned = {Pose{{1e9, 0.0, 0.0}, 0.0}};
  step.step.robots[0].travelled = 1;
  const std::string good = detail::step_bytes(step, head_, 0, kRecordingFormat);
  const auto as_bytes = [](double number) {
    std::string text(sizeof number, '\0');
    std::memcpy(text.data(), &number, sizeof number);
    return text;
  };
  for (const double x : {1e9, 1.001e9, -1e300}) {
    const std::string changed = test::replaced(good, as_bytes(1e9), as_bytes(x));
    const std::string said = complaint(head + detail::packed_record(detail::kStepTag, changed));
    EXPECT_EQ(said.find("a pose is more than 1e9 m away") != std::string::npos, x != 1e9) << said;
  }
  step.step.robots[0].planned[0].position.x() = 1.001e9;
  EXPECT_THROW(RecordingWriter(file_, head_).write(step), std::invalid_argument);
}

TEST_F(RecordingDamageTest, EveryFlippedByteIsFound) {
  record(2, 4, true);
  const std::string whole = bytes();
  for (std::size_t at = 0; at < whole.size(); ++at)
    for (const int mask : {0x01, 0xFF, 0x10, 0x80}) {
      if (mask != 0x01 && mask != 0xFF && !test::long_mode()) break;
      std::string flipped = whole;
      flipped[at] = static_cast<char>(flipped[at] ^ mask);
      const std::string said = complaint(flipped);
      ASSERT_NE(said, "") << "byte " << at << ", mask " << mask;
      const bool in_title = at < std::string("frontlux recording, format 5\n").size();
      // As format 4 the file can be begun to be read.
      const bool other_format = flipped.starts_with("frontlux recording, format 4\n");
      ASSERT_EQ(said.find("damaged at byte ") == std::string::npos, in_title && !other_format) << said;
    }
}

TEST_F(RecordingDamageTest, FlippedBytesOfAnUnfinishedTail) {
  const auto sizes = record(3, 4, false);
  const std::string cut = bytes().substr(0, sizes[3] - 7);
  for (std::size_t at = 0; at < cut.size(); ++at) {
    std::string flipped = cut;
    flipped[at] = static_cast<char>(flipped[at] ^ 0x21);
    const std::string said = complaint(flipped);
    if (at < sizes[2]) {
      ASSERT_NE(said, "") << at;
    } else if (said.empty()) {
      const Recording recording = read_recording(file_);
      EXPECT_TRUE(recording.truncated);
      expect_steps(recording, 2);
    }
  }
}

TEST_F(RecordingDamageTest, ZerosAtTheEndAreAnUnfinishedStep) {
  const auto sizes = record(2, 4, false);
  save(bytes() + std::string(5000, '\0'));
  const Recording recording = read_recording(file_);
  EXPECT_TRUE(recording.truncated);
  EXPECT_EQ(recording.bytes, sizes[2]);
  expect_steps(recording, 2);
}

// As a machine leaves it that lost its power, from every byte of the file on.
TEST_F(RecordingDamageTest, ZerosFromAnyByteOnAreAnUnfinishedStep) {
  const auto sizes = record(2, 6, true);
  const std::string whole = bytes();
  for (const std::size_t more : {std::size_t{0}, std::size_t{1}, std::size_t{5000}})
    for (std::size_t cut = 0; cut < whole.size(); ++cut) {
      SCOPED_TRACE(std::to_string(more) + " bytes more, zeros from byte " + std::to_string(cut));
      const std::string zeroed = whole.substr(0, cut) + std::string(whole.size() - cut + more, '\0');
      if (zeroed.substr(0, whole.size()) == whole) continue;  // they were zeros before
      if (cut < sizes[0]) {
        expect_refused(zeroed, "begin it anew");
        continue;
      }
      save(zeroed);
      const Recording recording = read_recording(file_);
      std::size_t count = 0;
      while (count + 1 < sizes.size() && sizes[count + 1] <= cut) ++count;
      ASSERT_NO_FATAL_FAILURE(expect_steps(recording, count));
      EXPECT_EQ(recording.bytes, sizes[count]);
      EXPECT_TRUE(recording.truncated);
      EXPECT_EQ(recording.end, std::nullopt);
    }
  // Zeros within the file are damage, and so is anything behind those at its end.
  for (std::size_t at = sizes[0]; at + 8 < whole.size(); ++at) {
    std::string holed = whole;
    if (holed.replace(at, 4, 4, '\0') != whole) expect_refused(holed, "is damaged at byte ");
  }
  expect_refused(whole.substr(0, sizes[1] + 20) + std::string(5000, '\0') + "x", "is damaged at byte ");
  // Those after a run's end are nothing.
  save(whole + std::string(100, '\0'));
  EXPECT_EQ(read_recording(file_).end, "low_gain");
  EXPECT_FALSE(read_recording(file_).truncated);
}

// Damage that the checksums do not show, as somebody hostile would make it.
TEST_F(RecordingDamageTest, EveryChangedByteOfAStepIsHarmless) {
  const auto sizes = record(1, 6, false);
  const std::string before = bytes().substr(0, sizes[0]);
  const std::string plain = detail::step_bytes(steps_[0], head_, 0);
  int refused = 0, read = 0;
  for (std::size_t at = 0; at < plain.size(); ++at) {
    for (const int value : {0x00, 0x01, 0x7F, 0x80, 0xFF}) {
      std::string changed = plain;
      changed[at] = static_cast<char>(value);
      complaint(before + detail::packed_record("step", changed)).empty() ? ++read : ++refused;
    }
    EXPECT_NE(complaint(before + detail::packed_record("step", plain.substr(0, at))), "");
  }
  EXPECT_GT(refused, 100);
  EXPECT_GT(read, 100);
  expect_refused(before + detail::packed_record("step", plain + "x"), "1 bytes too many");
}

TEST_F(RecordingDamageTest, AnnouncedSizesAllocateNothing) {
  record(0, 0, false);
  const std::string before = bytes();
  // A list of 2^60 robots' known voxels.
  const std::string first = std::string(6, '\0') + std::string(56, '\0');
  expect_refused(before + detail::packed_record("step", first + "\x80\x80\x80\x80\x80\x80\x80\x80\x10"),
                 "there is not one number for each robot");
  // As many robots in a team as fit into a million bytes.
  RecordingHead crowd = head_;
  crowd.robots.resize(1001, crowd.robots.front());
  crowd.starts.resize(1001);
  EXPECT_THROW(static_cast<void>(detail::head_bytes(crowd)), std::invalid_argument);
  crowd.robots.resize(1000);
  crowd.starts.resize(1000);
  EXPECT_EQ(detail::head_from(detail::head_bytes(crowd)).robots.size(), 1000U);
  // A gigabyte of zeros would compress to a megabyte: announced in a record of a few bytes.
  std::string bomb = detail::packed_record("step", std::string(1000, '\0'));
  bomb[8] = bomb[9] = bomb[10] = '\xFF';
  expect_refused(before + bomb, "fail their checksum");
}

TEST_F(RecordingDamageTest, FullDiskIsNamed) {
  Random random(1);
  head_ = test::random_head(random, 1);
  std::filesystem::create_symlink("/dev/full", file_);
  const std::string said = complaint_of<std::runtime_error>([&] { RecordingWriter(file_, head_); });
  EXPECT_TRUE(said.starts_with(file_.string() + ": cannot be written: disk full")) << said;
}

// Lets files grow to a size only, as a disk with so much room does.
class FileSizeLimit {
 public:
  explicit FileSizeLimit(std::size_t bytes) : handler_(std::signal(SIGXFSZ, SIG_IGN)) {
    getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit limit{bytes, before_.rlim_max};
    setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~FileSizeLimit() {
    setrlimit(RLIMIT_FSIZE, &before_);
    std::signal(SIGXFSZ, handler_);
  }
  FileSizeLimit(const FileSizeLimit&) = delete;
  FileSizeLimit& operator=(const FileSizeLimit&) = delete;

 private:
  rlimit before_{};
  void (*handler_)(int);
};

TEST_F(RecordingDamageTest, AFailedWriteLeavesTheStepsBefore) {
  const auto sizes = record(3, 50, false);
  const std::string whole = bytes();
  save(whole.substr(0, sizes[1]));
  RecordingWriter writer(file_, read_recording(file_));
  {
    const FileSizeLimit limit(sizes[2] - 10);
    test::expect_complaint<std::runtime_error>([&] { writer.write(steps_[1]); }, {"cannot be written"});
    EXPECT_EQ(bytes(), whole.substr(0, sizes[1]));
  }
  writer.write(steps_[1]);
  writer.write(steps_[2]);
  EXPECT_EQ(bytes(), whole) << "it goes on when there is room again";
}

}  // namespace
}  // namespace frontlux::planner
