#include "sampling/atomic_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstdio>
#include <system_error>

#include "sampling/error.h"

namespace abn {
namespace {

namespace fs = std::filesystem;

// More than this in one write() is cut by the kernel anyway.
constexpr std::size_t max_write = std::size_t{1} << 30;

/// Owns a file descriptor.
class Descriptor {
 public:
  Descriptor(const fs::path& path, int flags) : number_(::open(path.c_str(), flags | O_CLOEXEC, 0666)) {}
  ~Descriptor() {
    if (number_ >= 0) ::close(number_);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;

  int number() const { return number_; }
  bool open() const { return number_ >= 0; }
  /// 0 or the error: some file systems report a failed write only now.
  int close() {
    const int result = ::close(number_);
    number_ = -1;
    return result == 0 ? 0 : errno;
  }

 private:
  int number_;
};

/// 0 or the error.
int write_all(int descriptor, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(descriptor, bytes.data(), std::min(bytes.size(), max_write));
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) return written < 0 ? errno : EIO;
    bytes.remove_prefix(static_cast<std::size_t>(written));
  }
  return 0;
}

/// 0 or the error; a file that cannot be synchronised (a pipe) needs none.
int synchronise(int descriptor) {
  if (::fsync(descriptor) == 0 || errno == EINVAL || errno == ENOTSUP) return 0;
  return errno;
}

[[noreturn]] void throw_write_error(const fs::path& file, int error) {
  throw IoError("cannot write '" + file.string() + "': " + std::generic_category().message(error) + "; " +
                write_remedy(error));
}

/// Renaming onto these would replace the device, or the shell's redirection, by a file.
bool is_device(const fs::path& target) {
  const std::string text = target.lexically_normal().string();
  if (text == "/dev/stdout" || text == "/dev/stderr" || text.starts_with("/dev/fd/") || text.starts_with("/proc/")) {
    return true;
  }
  std::error_code ignored;
  const auto type = fs::status(target, ignored).type();
  return type == fs::file_type::character || type == fs::file_type::block || type == fs::file_type::fifo ||
         type == fs::file_type::socket;
}

fs::path resolve_link(const fs::path& target) {
  std::error_code error;
  if (!fs::is_symlink(fs::symlink_status(target, error))) return target;
  const fs::path resolved = fs::weakly_canonical(target, error);
  return error ? target : resolved;
}

fs::path folder_of(const fs::path& file) { return file.has_parent_path() ? file.parent_path() : fs::path("."); }

}  // namespace

std::string write_remedy(int error) {
  switch (error) {
    case ENOSPC:
    case EDQUOT:
      return "the disk is full: free space or name a file on another disk";
    case EFBIG:
      return "the file grew over a size limit: raise it (ulimit -f) or name another disk";
    case ENOENT:
      return "create the folder first";
    case ENOTDIR:
      return "a part of the path is a file: name a file in a folder";
    case EISDIR:
      return "name a file, not a folder";
    case EACCES:
    case EPERM:
    case EROFS:
      return "name a file in a folder you may write to";
    case ENAMETOOLONG:
      return "give a shorter name";
    case EMFILE:
    case ENFILE:
      return "too many files are open: raise the limit (ulimit -n)";
    default:
      return "check the path and the disk";
  }
}

AtomicFile::AtomicFile(const fs::path& target) : shown_(target), target_(resolve_link(target)) {
  if (target_.empty() || !target_.has_filename()) fail(target_.empty() ? ENOENT : EISDIR);
  if (is_device(target_)) {
    throw IoError("cannot write '" + shown_.string() + "': it is a device or a pipe; name a regular file");
  }
  std::error_code ignored;
  if (fs::is_directory(target_, ignored)) fail(EISDIR);

  static std::atomic<unsigned> counter{0};
  for (;;) {
    const std::string name = ".abn-" + std::to_string(::getpid()) + "-" + std::to_string(counter++) + ".tmp";
    temporary_ = folder_of(target_) / (name + target_.extension().string());
    Descriptor created(temporary_, O_WRONLY | O_CREAT | O_EXCL);
    if (created.open()) return;
    if (errno != EEXIST) fail(errno);  // a stale temporary of a killed process with our number: next name
  }
}

AtomicFile::~AtomicFile() {
  if (committed_) return;
  std::error_code ignored;
  fs::remove(temporary_, ignored);
}

void AtomicFile::fail(int error) const { throw_write_error(shown_, error); }

void AtomicFile::write(std::string_view bytes) {
  Descriptor file(temporary_, O_WRONLY | O_APPEND);
  if (!file.open()) fail(errno);
  if (const int error = write_all(file.number(), bytes); error != 0) fail(error);
  if (const int error = file.close(); error != 0) fail(error);
}

void AtomicFile::commit() {
  Descriptor file(temporary_, O_RDONLY);
  if (!file.open()) fail(errno);
  if (const int error = synchronise(file.number()); error != 0) fail(error);
  if (const int error = file.close(); error != 0) fail(error);
  if (::rename(temporary_.c_str(), target_.c_str()) != 0) fail(errno);
  committed_ = true;
  // The new name itself: without this a crash may bring the old content back, whole; so a refusal is no error.
  Descriptor folder(folder_of(target_), O_RDONLY | O_DIRECTORY);
  if (folder.open()) ::fsync(folder.number());
}

void write_atomically(const fs::path& target, std::string_view bytes) {
  if (!is_device(target)) {
    AtomicFile file(target);
    file.write(bytes);
    file.commit();
    return;
  }
  Descriptor device(target, O_WRONLY);
  if (!device.open()) throw_write_error(target, errno);
  if (const int error = write_all(device.number(), bytes); error != 0) throw_write_error(target, error);
  if (const int error = device.close(); error != 0) throw_write_error(target, error);
}

}  // namespace abn
