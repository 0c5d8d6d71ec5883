// Files that appear complete or not at all.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace abn {

/// A new file under a temporary name beside its target, with the target's extension, so that libraries which write by
/// name and choose the format by extension (OpenImageIO) can fill it. commit() gives it its name; without commit() the
/// destructor removes it and whatever stood under the target name is untouched. A symbolic link is followed.
class AtomicFile {
 public:
  /// Creates the empty temporary. Throws IoError (file, reason, remedy) if the folder is missing or not writable, or if
  /// the target is a folder or a device.
  explicit AtomicFile(const std::filesystem::path& target);
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  /// Where to write until commit(); may be opened and replaced by name.
  const std::filesystem::path& temporary() const { return temporary_; }
  /// Appends to the temporary. Throws IoError.
  void write(std::string_view bytes);
  /// Brings the temporary to the disk and renames it. Throws IoError; the temporary is then removed by the destructor.
  void commit();

 private:
  [[noreturn]] void fail(int error) const;

  std::filesystem::path shown_;   // the target as the caller named it: for messages
  std::filesystem::path target_;  // with links resolved
  std::filesystem::path temporary_;
  bool committed_ = false;
};

/// Writes `bytes` as the whole content of `target`, complete or not at all. A target that is no regular file (a pipe, a
/// device such as /dev/stdout) cannot be renamed onto and is written directly. Throws IoError (file, reason, remedy).
void write_atomically(const std::filesystem::path& target, std::string_view bytes);

/// What a person can do about the system error `error` of a write: one phrase.
std::string write_remedy(int error);

}  // namespace abn
