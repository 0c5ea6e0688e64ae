#include "mesh/import_process.hpp"

#include <frontlux/machine.hpp>

#include <sys/resource.h>
#include <sys/wait.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstddef>
#include <exception>
#include <fcntl.h>
#include <memory>
#include <new>
#include <stdexcept>
#include <string>
#include <system_error>
#include <unistd.h>
#include <vector>

#if defined(__linux__)
#include <sys/prctl.h>
#endif

namespace frontlux::sim {
namespace {

constexpr std::uint64_t kMebibyte = std::uint64_t{1} << 20U;
constexpr std::uint64_t kFewBytes = 512 * kMebibyte,
                        kBytesOfMemory = 200;  // beside, and for each byte of a file
constexpr std::uint64_t kFewSeconds = 8, kBytesInSecond = kMebibyte / 2;

// What a child sends first.
enum class Outcome : char { kMesh = 'm', kError = 'e', kNoMemory = 'n' };

// The sanitizers reserve far more addresses than a program uses.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool kLimitsAddresses = false;
#elif defined(__has_feature)
constexpr bool kLimitsAddresses = !__has_feature(address_sanitizer) && !__has_feature(thread_sanitizer);
#else
constexpr bool kLimitsAddresses = true;
#endif

void set_limit(int resource, std::uint64_t most) {
  ::rlimit limit{};
  ::getrlimit(resource, &limit);
  limit.rlim_cur = std::min<::rlim_t>(most, limit.rlim_max);
  ::setrlimit(resource, &limit);
}

class Descriptor {
 public:
  explicit Descriptor(int number) : number_(number) {}
  ~Descriptor() { ::close(number_); }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;

  void write(const void* data, std::size_t size) const {
    for (auto at = static_cast<const char*>(data); size > 0;) {
      const ::ssize_t done = ::write(number_, at, size);
      if (done < 0 && errno != EINTR) ::_exit(1);
      at += std::max<::ssize_t>(done, 0);
      size -= static_cast<std::size_t>(std::max<::ssize_t>(done, 0));
    }
  }
  // False if there are not so many bytes.
  [[nodiscard]] bool read(void* data, std::size_t size) const {
    for (auto at = static_cast<char*>(data); size > 0;) {
      const ::ssize_t done = ::read(number_, at, size);
      if (done == 0 || (done < 0 && errno != EINTR)) return false;
      at += std::max<::ssize_t>(done, 0);
      size -= static_cast<std::size_t>(std::max<::ssize_t>(done, 0));
    }
    return true;
  }
  template <class Value>
  void write_list(const std::vector<Value>& list) const {
    const std::uint64_t size = list.size();
    write(&size, sizeof size);
    write(list.data(), size * sizeof(Value));
  }
  template <class List>
  [[nodiscard]] bool read_list(List& list) const {
    std::uint64_t size = 0;
    if (!read(&size, sizeof size)) return false;
    list.resize(static_cast<std::size_t>(size));
    return read(list.data(), list.size() * sizeof list[0]);
  }

 private:
  int number_;
};

[[noreturn]] void import_and_exit(const Descriptor& out, const std::function<io::RawMesh()>& import) {
  const auto send = [&](Outcome outcome, const std::string& text) {
    out.write(&outcome, sizeof outcome);
    out.write_list(std::vector<char>(text.begin(), text.end()));
  };
  try {
#if defined(__linux__)
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);
#endif
    std::signal(SIGXCPU, SIG_DFL);
    set_limit(RLIMIT_CORE, 0);
    const int nowhere = ::open("/dev/null", O_RDWR);
    for (const int stream : {STDOUT_FILENO, STDERR_FILENO}) ::dup2(nowhere, stream);
    const io::RawMesh mesh = import();
    const Outcome outcome = Outcome::kMesh;
    out.write(&outcome, sizeof outcome);
    out.write_list(mesh.vertices);
    out.write_list(mesh.triangles);
  } catch (const std::bad_alloc&) {
    set_limit(RLIMIT_AS, RLIM_INFINITY);
    send(Outcome::kNoMemory, "");
  } catch (const std::exception& error) {
    send(Outcome::kError, error.what());
  } catch (...) {
    send(Outcome::kError, "unknown error");
  }
  ::_exit(0);
}

// `status`: -1 if nobody knows, since the process ignores the ends of its children
std::string describe(int status) {
  if (status == -1) return "makes the importer crash, or takes too long or too much memory to import";
  if (WIFSIGNALED(status) && WTERMSIG(status) == SIGXCPU)
    return "takes longer to import than " + std::to_string(kFewSeconds) + " s and " +
           std::to_string(kMebibyte / kBytesInSecond) + " s for each MiB";
  return "makes the importer crash" +
         (WIFSIGNALED(status) ? ", by signal " + std::to_string(WTERMSIG(status)) : std::string());
}

constexpr const char* kNoMemory = "takes more memory to import than ";

}  // namespace

void limit_import(std::uint64_t bytes) {
  static const std::uint64_t already = address_space();  // before the first file
  if (kLimitsAddresses && already > 0) set_limit(RLIMIT_AS, already + kFewBytes + kBytesOfMemory * bytes);
  set_limit(RLIMIT_CPU, kFewSeconds + bytes / kBytesInSecond);
}

io::RawMesh import_in_child(const std::function<io::RawMesh()>& import) {
  int ends[2];
  if (::pipe2(ends, O_CLOEXEC) != 0)
    throw std::system_error(errno, std::generic_category(), "cannot be imported");
  const Descriptor in(ends[0]);
  auto out = std::make_unique<Descriptor>(ends[1]);
  const ::pid_t child = ::fork();
  if (child == 0) import_and_exit(*out, import);
  out.reset();
  if (child < 0) throw std::system_error(errno, std::generic_category(), "cannot be imported");

  // The child is waited for whatever is read.
  struct Waiting {
    ::pid_t child;
    int status = 0;
    bool done = false;
    int wait() {
      while (!done && ::waitpid(child, &status, 0) < 0) {
        if (errno == EINTR) continue;
        status = -1;
        break;
      }
      done = true;
      return status;
    }
    ~Waiting() {
      if (!done) ::kill(child, SIGKILL);
      static_cast<void>(wait());
    }
  } waiting{child};

  Outcome outcome{};
  io::RawMesh mesh;
  std::string text;
  bool whole = in.read(&outcome, sizeof outcome);
  if (whole && outcome == Outcome::kMesh)
    whole = in.read_list(mesh.vertices) && in.read_list(mesh.triangles);
  else if (whole)
    whole = in.read_list(text);
  const int status = waiting.wait();
  if (!whole || (status != 0 && status != -1)) throw std::runtime_error(describe(status));
  if (outcome == Outcome::kNoMemory)
    throw std::runtime_error(kNoMemory + std::to_string(kFewBytes / kMebibyte) + " MiB and " +
                             std::to_string(kBytesOfMemory) + " times its size");
  if (outcome != Outcome::kMesh) throw std::runtime_error(text);
  return mesh;
}

}  // namespace frontlux::sim
