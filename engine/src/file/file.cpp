#include <frontlux/file.hpp>

#include <sys/file.h>
#include <sys/stat.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <cstddef>
#include <fcntl.h>
#include <fstream>
#include <stdexcept>
#include <unistd.h>
#include <utility>

namespace frontlux {
namespace {

// And the number of the process that writes it, and that of the file among those it writes: map.ot becomes
// map.ot.part-frontlux-1234-0.
constexpr std::string_view kUnfinished = ".part-frontlux-";

// The names of files that are being written. Who takes one out of its place has it for himself.
constexpr std::size_t kAtOnce = 64;
std::array<std::atomic<const char*>, kAtOnce> being_written{};
static_assert(std::atomic<const char*>::is_always_lock_free);

// Locked for as long as somebody writes it, whatever his number is: processes of two containers may have the
// same one. Removed, unless it gets its name.
class UnfinishedFile {
 public:
  explicit UnfinishedFile(const std::filesystem::path& file) {
    constexpr std::size_t kNames = 10'000;
    const std::string begin = file.string().append(kUnfinished) + std::to_string(::getpid()) + "-";
    bool taken = true;
    for (std::size_t number = 0; taken && number < kNames; ++number) {
      path_ = begin + std::to_string(number);
      note();
      descriptor_ = ::open(path_.c_str(), O_CREAT | O_EXCL | O_RDWR | O_CLOEXEC, 0666);
      taken = descriptor_ < 0 ? errno == EEXIST : !is_ours();
      if (descriptor_ < 0) forget();
    }
  }
  ~UnfinishedFile() {
    if (descriptor_ < 0) return;
    std::error_code ignored;
    if (!named_) std::filesystem::remove(path_, ignored);
    forget();
    ::close(descriptor_);
  }
  UnfinishedFile(const UnfinishedFile&) = delete;
  UnfinishedFile& operator=(const UnfinishedFile&) = delete;

  /// @return false if it could not be made; errno says why
  [[nodiscard]] bool exists() const { return descriptor_ >= 0; }
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

  [[nodiscard]] std::error_code take_name(const std::filesystem::path& file) {
    std::error_code error;
    forget();  // from here on another thread may make a file of the same name
    std::filesystem::rename(path_, file, error);
    named_ = !error;
    return error;
  }

 private:
  // Whether it is locked, and nobody removed it before that. File systems without locks do without.
  [[nodiscard]] bool is_ours() {
    struct stat status {};
    const bool removing = ::flock(descriptor_, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK;
    if (!removing && ::fstat(descriptor_, &status) == 0 && status.st_nlink > 0) return true;
    ::close(std::exchange(descriptor_, -1));
    return false;
  }

  // Before it is there, so that no signal comes between.
  void note() {
    for (std::atomic<const char*>& place : being_written)
      if (const char* none = nullptr; place.compare_exchange_strong(none, path_.c_str())) {
        place_ = &place;
        return;
      }
  }

  // A signal that has taken the name ends the process soon: it needs the name until then.
  void forget() {
    if (place_ != nullptr && std::exchange(place_, nullptr)->exchange(nullptr) == nullptr)
      for (;;) ::pause();
  }

  std::filesystem::path path_;
  int descriptor_ = -1;
  bool named_ = false;
  std::atomic<const char*>* place_ = nullptr;
};

// Removes an unfinished file that nobody is writing. It is locked until it is gone: whoever has just made it
// looks whether it is still there once he has the lock himself. Where files cannot be locked, it stays.
void remove_if_abandoned(const std::filesystem::path& file) {
  const int descriptor = ::open(file.c_str(), O_RDWR | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
  if (descriptor < 0) return;
  struct stat locked = {}, named = {};  // another one may have the name by now
  if (::flock(descriptor, LOCK_EX | LOCK_NB) == 0 && ::fstat(descriptor, &locked) == 0 &&
      ::lstat(file.c_str(), &named) == 0 && locked.st_dev == named.st_dev && locked.st_ino == named.st_ino)
    ::unlink(file.c_str());
  ::close(descriptor);
}

// Else a loss of power after a file got its name could leave it empty.
// @return false if the disk says why it cannot, with errno; some file systems have nothing to say
bool reach_disk(const std::filesystem::path& file) {
  const int descriptor = ::open(file.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor < 0) return false;
  const bool lost = ::fsync(descriptor) != 0 && errno != EINVAL && errno != ENOSYS;
  const int why = errno;
  ::close(descriptor);
  errno = why;
  return !lost;
}

}  // namespace

void fail(const std::filesystem::path& file, const std::string& what, const std::string& advice) {
  throw std::runtime_error((file.empty() ? "''" : file.string()) + ": " + what + "; " + advice);
}

std::string read_file(const std::filesystem::path& file, std::uint64_t max_bytes) {
  std::error_code error;
  const auto status = std::filesystem::status(file, error);
  if (status.type() == std::filesystem::file_type::not_found)
    fail(file, "there is no such file", "check the path");
  if (error) fail(file, "cannot be inspected: " + error.message(), "check the path and its permissions");
  if (std::filesystem::is_directory(status)) fail(file, "is a directory", "name a file in it");
  if (!std::filesystem::is_regular_file(status)) fail(file, "is not a regular file", "name a file");
  errno = 0;
  std::ifstream stream(file, std::ios::binary);
  if (!stream)
    fail(file, "cannot be opened: " + std::generic_category().message(errno), "check its permissions");
  // Of the file that is open: another one may have taken its name.
  const std::streamoff end = stream.seekg(0, std::ios::end).tellg();
  if (end < 0) fail(file, "has no size", "check the path and its permissions");
  const auto size = static_cast<std::uint64_t>(end);
  stream.seekg(0);
  if (size > max_bytes)
    fail(file,
         "has " + std::to_string(size) + " bytes, more than the " + std::to_string(max_bytes) +
             " that can be read",
         "split it, or make it coarser");
  std::string bytes(static_cast<std::size_t>(size), '\0');
  stream.read(bytes.data(), static_cast<std::streamsize>(size));
  if (static_cast<std::uint64_t>(stream.gcount()) != size)
    fail(file, "gave " + std::to_string(stream.gcount()) + " of its " + std::to_string(size) + " bytes",
         "try again when nothing writes to it");
  return bytes;
}

void remove_unfinished(const std::filesystem::path& file) {
  const std::string begin = file.filename().string().append(kUnfinished);
  const auto folder = file.has_parent_path() ? file.parent_path() : std::filesystem::path(".");
  std::error_code error;
  for (std::filesystem::directory_iterator entry(folder, error), end; !error && entry != end;
       entry.increment(error)) {
    const std::string name = entry->path().filename().string();
    if (!name.starts_with(begin)) continue;
    const std::string_view rest = std::string_view(name).substr(begin.size());
    if (number_from<::pid_t>(rest.substr(0, rest.find('-')))) remove_if_abandoned(entry->path());
  }
}

void remove_own_unfinished() noexcept {
  for (std::atomic<const char*>& place : being_written)
    if (const char* const path = place.exchange(nullptr)) ::unlink(path);
}

void write_file(const std::filesystem::path& file, const std::function<void(std::ostream&)>& write) {
  const auto cannot = [&file](const std::string& what, const std::string& advice) {
    fail(file, "cannot be written: " + what, advice);
  };
  std::error_code error;
  if (std::filesystem::is_directory(file, error)) cannot("it is a folder", "name a file in it");
  // The new file would take the name of a device or a pipe.
  if (std::filesystem::exists(file, error) && !std::filesystem::is_regular_file(file, error))
    cannot("it is not a regular file", "name a file");
  remove_unfinished(file);
  errno = 0;
  UnfinishedFile part(file);
  std::ofstream stream;
  stream.imbue(std::locale::classic());  // the same bytes, whatever the process has set
  if (part.exists()) stream.open(part.path(), std::ios::binary | std::ios::trunc);
  if (!stream.is_open())
    cannot(std::generic_category().message(errno), "check that its folder exists and may be written to");
  write(stream);
  stream.close();
  if (!stream || !reach_disk(part.path()))
    cannot(std::generic_category().message(errno), "check the space left on the disk");
  error = part.take_name(file);
  if (error) cannot(error.message(), "check the permissions of the folder and of the file that is there");
}

void write_file(const std::filesystem::path& file, std::string_view bytes) {
  write_file(file, [&](std::ostream& stream) { stream << bytes; });
}

std::string lower_extension(const std::filesystem::path& file) {
  std::string extension = file.extension().string();
  for (char& c : extension)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return extension;
}

std::string quote(std::string_view text) {
  constexpr std::size_t kShown = 40;
  std::string shown = "'";
  for (const char c : text.substr(0, kShown)) shown += c >= ' ' && c <= '~' ? c : '?';
  if (text.size() > kShown) shown += "...";
  return shown + "'";
}

}  // namespace frontlux
