#include "recording/packed_record.hpp"
#include "recording/recording_format.hpp"

#include <frontlux/file.hpp>
#include <frontlux/planner/recording.hpp>

#include <sys/file.h>
#include <sys/stat.h>

#include <cerrno>
#include <fcntl.h>
#include <stdexcept>
#include <string>
#include <string_view>
#include <system_error>
#include <unistd.h>
#include <utility>

namespace frontlux::planner {
namespace {

[[noreturn]] void fail_to_write(const std::filesystem::path& file, int error) {
  const bool full = error == ENOSPC || error == EDQUOT || error == EFBIG;
  fail(file, "cannot be written: " + (full ? "disk full" : std::generic_category().message(error)),
       full ? "make room" : "check that its folder exists, and the permissions of both");
}

// An open file that holds finished records only, as far as that can be had.
class RecordFile {
 public:
  RecordFile(std::filesystem::path file, int flags)
      : file_(std::move(file)), descriptor_(::open(file_.c_str(), flags | O_WRONLY | O_CLOEXEC, 0666)) {
    if (descriptor_ < 0) fail_to_write(file_, errno);
    // Where a file system knows no locks, two writers go unnoticed.
    if (::flock(descriptor_, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
      ::close(descriptor_);
      fail(file_, "another process is writing it", "wait for its end");
    }
  }
  ~RecordFile() { ::close(descriptor_); }
  RecordFile(const RecordFile&) = delete;
  RecordFile& operator=(const RecordFile&) = delete;

  // Forgets what comes after so many bytes.
  void cut(std::uint64_t size) {
    check_name();
    if (::ftruncate(descriptor_, static_cast<::off_t>(size)) != 0 ||
        ::lseek(descriptor_, static_cast<::off_t>(size), SEEK_SET) < 0 || ::fsync(descriptor_) != 0)
      fail_to_write(file_, errno);
    size_ = size;
  }

  // All of it, on the disk, or none.
  void append(std::string_view bytes) {
    if (const struct ::stat written = check_name();
        S_ISREG(written.st_mode) && static_cast<std::uint64_t>(written.st_size) != size_)
      lost("was cut or written to");
    int error = 0;
    for (std::string_view left = bytes; error == 0 && !left.empty();) {
      const ::ssize_t written = ::write(descriptor_, left.data(), left.size());
      if (written > 0)
        left.remove_prefix(static_cast<std::size_t>(written));
      else if (written == 0 || errno != EINTR)
        error = written == 0 ? EIO : errno;
    }
    // A device or a pipe has nothing to flush.
    if (error == 0 && ::fsync(descriptor_) != 0 && errno != EINVAL && errno != ENOTSUP) error = errno;
    if (error == 0) {
      size_ += bytes.size();
      return;
    }
    // If the file cannot be cut back either, its readers leave out the unfinished record.
    if (::ftruncate(descriptor_, static_cast<::off_t>(size_)) == 0)
      static_cast<void>(::lseek(descriptor_, static_cast<::off_t>(size_), SEEK_SET));
    fail_to_write(file_, error);
  }

 private:
  // The open file has to be the one of that name still.
  struct ::stat check_name() const {
    struct ::stat open {
    }, named{};
    if (::fstat(descriptor_, &open) != 0) fail_to_write(file_, errno);
    if (::stat(file_.c_str(), &named) != 0) lost("was deleted or moved");
    if (named.st_dev != open.st_dev || named.st_ino != open.st_ino) lost("was replaced");
    return open;
  }
  [[noreturn]] void lost(const std::string& how) const {
    fail(file_, how + " by another process while this one wrote it",
         "leave the files of a run alone until its end");
  }

  std::filesystem::path file_;
  int descriptor_;
  std::uint64_t size_ = 0;
};

}  // namespace

struct RecordingWriter::State {
  State(const std::filesystem::path& path, int flags, RecordingHead run, int in_format, std::uint64_t number)
      : file(path, flags), head(std::move(run)), format(in_format), next(number) {}
  RecordFile file;
  RecordingHead head;
  int format;
  std::uint64_t next;
  bool ended = false;
};

RecordingWriter::RecordingWriter(const std::filesystem::path& file, const RecordingHead& head) {
  const std::string begin = std::string(detail::kRecordingTitle) + std::to_string(kRecordingFormat) + "\n" +
                            detail::packed_record(detail::kHeadTag, detail::head_bytes(head));
  std::error_code ignored;
  state_ = std::make_unique<State>(file, O_CREAT, head, kRecordingFormat, 0);
  // Only now, since the file may be another process's, which has it locked.
  if (std::filesystem::is_regular_file(file, ignored)) state_->file.cut(0);
  state_->file.append(begin);
}

RecordingWriter::RecordingWriter(const std::filesystem::path& file, const Recording& recording) {
  state_ = std::make_unique<State>(file, 0, recording.head, recording.format, recording.steps.size());
  // Now that it is locked: until then its owner may have gone on.
  if (read_recording(file).bytes != recording.bytes)
    fail(file, "was written to by another process since it was read", "read it again");
  state_->file.cut(recording.bytes);
}

RecordingWriter::~RecordingWriter() = default;
RecordingWriter::RecordingWriter(RecordingWriter&&) noexcept = default;
RecordingWriter& RecordingWriter::operator=(RecordingWriter&&) noexcept = default;

void RecordingWriter::write(const RecordedStep& step) {
  if (state_->ended) throw std::invalid_argument("recording: a step after its end");
  state_->file.append(detail::packed_record(
      detail::kStepTag, detail::step_bytes(step, state_->head, state_->next, state_->format)));
  ++state_->next;
}

void RecordingWriter::write_end(const std::string& reason) {
  if (state_->ended) throw std::invalid_argument("recording: a second end");
  state_->file.append(detail::packed_record(detail::kEndTag, detail::end_bytes(reason)));
  state_->ended = true;
}

}  // namespace frontlux::planner
