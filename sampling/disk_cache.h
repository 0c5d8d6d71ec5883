// Results that depend on no image, kept on the disk between runs.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <optional>
#include <span>
#include <string_view>
#include <type_traits>
#include <vector>

namespace abn {

/// A folder of files, one per key, of bounded total size. A cache is never an error: what cannot be read is a miss,
/// what cannot be written is not kept. Any number of processes may share the folder.
///
/// A file is named by a 128-bit hash of its key and holds the whole key, the length and a checksum of the bytes, so
/// that a foreign, truncated or corrupted file, or another key of the same hash, is a miss (and is overwritten by the
/// next store()). Files appear complete or not at all (AtomicFile).
class DiskCache {
 public:
  static constexpr std::uint64_t default_limit = std::uint64_t{256} << 20;  // [B]

  /// An empty `folder` caches nothing. The folder is created by the first store(), readable for its owner only.
  explicit DiskCache(std::filesystem::path folder, std::uint64_t limit = default_limit);

  /// The bytes stored under `key`, or nothing; the entry becomes the youngest.
  std::optional<std::vector<std::byte>> load(std::string_view key) const;
  /// Keeps a copy of `bytes`; then, while all files together are larger than the limit, the ones unused for longest go.
  /// An entry larger than the limit is not kept.
  void store(std::string_view key, std::span<const std::byte> bytes) const;

  const std::filesystem::path& folder() const { return folder_; }

  /// What there is, for a person.
  struct Status {
    bool writable = false;  // or can be created
    std::uint64_t files = 0;
    std::uint64_t bytes = 0;
  };
  Status status() const;

 private:
  std::filesystem::path file_of(std::string_view key) const;
  void evict() const;

  std::filesystem::path folder_;
  std::uint64_t limit_;
};

/// $XDG_CACHE_HOME/abn, else $HOME/.cache/abn (XDG Base Directory Specification: relative paths do not count); empty if
/// neither is set.
std::filesystem::path cache_folder();

/// DiskCache(cache_folder()).load(key). A key names everything the bytes depend on, and a version of their format and
/// of the method that made them.
std::optional<std::vector<std::byte>> load_cached(std::string_view key);
/// DiskCache(cache_folder()).store(key, bytes).
void store_cached(std::string_view key, std::span<const std::byte> bytes);

/// As load_cached(), for values as they lie in memory; a miss if the length is no multiple of one. Whoever indexes by
/// them checks them first.
template <class T>
requires std::is_trivially_copyable_v<T> std::optional<std::vector<T>> load_cached_values(std::string_view key) {
  const auto bytes = load_cached(key);
  if (!bytes || bytes->size() % sizeof(T) != 0) return std::nullopt;
  std::vector<T> values(bytes->size() / sizeof(T));
  if (!values.empty()) std::memcpy(values.data(), bytes->data(), bytes->size());
  return values;
}

template <class T>
requires std::is_trivially_copyable_v<T>
void store_cached_values(std::string_view key, std::span<const T> values) { store_cached(key, std::as_bytes(values)); }

}  // namespace abn
