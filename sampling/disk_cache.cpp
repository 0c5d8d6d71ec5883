#include "sampling/disk_cache.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <bit>
#include <cerrno>
#include <cstdlib>
#include <exception>
#include <string>
#include <system_error>
#include <tuple>
#include <utility>

#include "sampling/atomic_file.h"
#include "sampling/hash.h"

namespace abn {
namespace {

namespace fs = std::filesystem;

constexpr const char* extension = ".cache";

/// What a file begins with; key and bytes follow. In the processor's byte order: another one's magic is foreign.
struct Header {
  std::uint64_t magic = 0;
  std::uint64_t key_length = 0;
  std::uint64_t length = 0;
  std::uint64_t checksum = 0;  // of key and bytes
};
constexpr std::uint64_t magic = 0x3165686361636E62U;  // "bncache1"
static_assert(sizeof(Header) == 32);

/// Words of eight bytes, mixed one after the other; the last one is filled with zeros, and the length counts.
std::uint64_t checksum(std::span<const std::byte> bytes, std::uint64_t start) {
  std::uint64_t sum = mix64(start ^ bytes.size());
  while (!bytes.empty()) {
    std::uint64_t word = 0;
    const std::size_t taken = std::min(bytes.size(), sizeof word);
    std::memcpy(&word, bytes.data(), taken);
    sum = std::rotl((sum ^ word) * 0x9E3779B97F4A7C15U, 29);
    bytes = bytes.subspan(taken);
  }
  return mix64(sum);
}

std::span<const std::byte> as_bytes(std::string_view text) { return std::as_bytes(std::span(text)); }

/// An open file, closed at the end.
class OpenFile {
 public:
  // Without O_NONBLOCK a pipe of that name would wait for a writer.
  explicit OpenFile(const fs::path& path) : number_(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK)) {}
  ~OpenFile() {
    if (number_ >= 0) ::close(number_);
  }
  OpenFile(const OpenFile&) = delete;
  OpenFile& operator=(const OpenFile&) = delete;

  /// The size of a regular file.
  std::optional<std::uint64_t> size() const {
    struct stat status {};
    if (number_ < 0 || ::fstat(number_, &status) != 0 || !S_ISREG(status.st_mode)) return std::nullopt;
    return static_cast<std::uint64_t>(status.st_size);
  }
  bool read(std::span<std::byte> into) const {
    while (!into.empty()) {
      const ssize_t got = ::read(number_, into.data(), into.size());
      if (got < 0 && errno == EINTR) continue;
      if (got <= 0) return false;
      into = into.subspan(static_cast<std::size_t>(got));
    }
    return true;
  }

 private:
  int number_;
};

fs::path absolute_folder(const char* variable) {
  const char* value = std::getenv(variable);
  const fs::path path = value == nullptr ? "" : value;
  return path.is_absolute() ? path : fs::path{};
}

struct Entry {
  fs::path path;
  fs::file_time_type used;
  std::uint64_t size = 0;
};

/// Our files in the folder, and what killed processes left of theirs; files that vanish meanwhile are left out.
std::vector<Entry> entries_of(const fs::path& folder) {
  std::vector<Entry> entries;
  std::error_code error;
  for (fs::directory_iterator at(folder, error); !error && at != fs::directory_iterator(); at.increment(error)) {
    if (at->path().extension() != extension) continue;
    std::error_code vanished;
    Entry entry{at->path(), at->last_write_time(vanished), 0};
    if (vanished) continue;
    entry.size = at->file_size(vanished);
    if (!vanished) entries.push_back(std::move(entry));
  }
  return entries;
}

}  // namespace

DiskCache::DiskCache(fs::path folder, std::uint64_t limit) : folder_(std::move(folder)), limit_(limit) {}

fs::path DiskCache::file_of(std::string_view key) const {
  std::string name;
  for (const std::uint64_t half : {checksum(as_bytes(key), 1), checksum(as_bytes(key), 2)}) {
    for (int shift = 60; shift >= 0; shift -= 4) name += "0123456789abcdef"[half >> shift & 15];
  }
  return folder_ / (name + extension);
}

std::optional<std::vector<std::byte>> DiskCache::load(std::string_view key) const {
  if (folder_.empty()) return std::nullopt;
  const fs::path path = file_of(key);
  const OpenFile file(path);
  const auto size = file.size();
  Header header;
  if (!size || *size < sizeof header || !file.read(std::as_writable_bytes(std::span(&header, 1)))) return std::nullopt;
  // Lengths are believed only where they add up to the file, so that nothing huge is allocated for garbage.
  const std::uint64_t rest = *size - sizeof header;
  if (header.magic != magic || header.key_length != key.size() || header.key_length > rest ||
      header.length != rest - header.key_length || *size > limit_) {
    return std::nullopt;
  }
  std::string stored_key(key.size(), '\0');
  std::vector<std::byte> bytes(header.length);
  if (!file.read(std::as_writable_bytes(std::span(stored_key))) || !file.read(bytes) || stored_key != key ||
      header.checksum != checksum(bytes, checksum(as_bytes(key), 0))) {
    return std::nullopt;
  }
  std::error_code ignored;
  fs::last_write_time(path, fs::file_time_type::clock::now(), ignored);
  return bytes;
}

void DiskCache::store(std::string_view key, std::span<const std::byte> bytes) const {
  const Header header{magic, key.size(), bytes.size(), checksum(bytes, checksum(as_bytes(key), 0))};
  if (folder_.empty() || sizeof header + key.size() + bytes.size() > limit_) return;
  try {
    std::error_code ignored;
    fs::create_directories(folder_.parent_path(), ignored);
    ::mkdir(folder_.c_str(), 0700);
    AtomicFile file(file_of(key));
    const auto text = [](std::span<const std::byte> raw) {
      return std::string_view(reinterpret_cast<const char*>(raw.data()), raw.size());
    };
    std::string start(text(std::as_bytes(std::span(&header, 1))));
    start += key;
    file.write(start);
    file.write(text(bytes));
    file.commit();
    evict();
  } catch (const std::exception&) {
    return;  // not kept: the caller has its bytes
  }
}

void DiskCache::evict() const {
  std::vector<Entry> entries = entries_of(folder_);
  std::uint64_t sum = 0;
  for (const Entry& entry : entries) sum += entry.size;
  std::sort(entries.begin(), entries.end(),
            [](const Entry& a, const Entry& b) { return std::tie(a.used, a.path) < std::tie(b.used, b.path); });
  for (const Entry& entry : entries) {
    if (sum <= limit_) break;
    std::error_code ignored;
    fs::remove(entry.path, ignored);
    sum -= entry.size;
  }
}

DiskCache::Status DiskCache::status() const {
  Status status;
  if (folder_.empty()) return status;
  for (const Entry& entry : entries_of(folder_)) {
    ++status.files;
    status.bytes += entry.size;
  }
  // The folder, or the nearest one above it in which it would be created.
  fs::path nearest = folder_;
  std::error_code error;
  while (!fs::exists(nearest, error) && nearest.has_relative_path()) nearest = nearest.parent_path();
  status.writable = fs::is_directory(nearest, error) && ::access(nearest.c_str(), W_OK | X_OK) == 0;
  return status;
}

fs::path cache_folder() {
  if (const fs::path home = absolute_folder("XDG_CACHE_HOME"); !home.empty()) return home / "abn";
  if (const fs::path home = absolute_folder("HOME"); !home.empty()) return home / ".cache" / "abn";
  return {};
}

std::optional<std::vector<std::byte>> load_cached(std::string_view key) { return DiskCache(cache_folder()).load(key); }

void store_cached(std::string_view key, std::span<const std::byte> bytes) {
  DiskCache(cache_folder()).store(key, bytes);
}

}  // namespace abn
