#include "harness/rows.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>

#include "sampling/atomic_file.h"
#include "sampling/error.h"

namespace abn::harness {
namespace {

int open_for_append(const std::filesystem::path& path) {
  const int descriptor = ::open(path.c_str(), O_WRONLY | O_APPEND | O_CLOEXEC);
  if (descriptor < 0)
    throw IoError(fmt::format("{}: cannot be opened for writing: {}", path.string(), std::strerror(errno)));
  return descriptor;
}

/// Cuts a file back to `end`; best effort, a reader drops a cut-off line anyway.
void cut_back(int descriptor, off_t end) {
  if (end >= 0 && ::ftruncate(descriptor, end) != 0) return;
}

/// One line, whole or not at all: a short write (full disk) is cut off again. Returns where the line begins.
off_t append_line(int descriptor, const std::filesystem::path& path, const std::string& line) {
  const off_t end = ::lseek(descriptor, 0, SEEK_END);
  const auto fail = [&](int reason) {
    cut_back(descriptor, end);
    throw IoError(fmt::format("{}: cannot be written: {}; {}, then go on with --resume", path.string(),
                              std::strerror(reason), write_remedy(reason)));
  };
  std::size_t written = 0;
  while (written < line.size()) {
    const ssize_t count = ::write(descriptor, line.data() + written, line.size() - written);
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) fail(count < 0 ? errno : EIO);
    written += static_cast<std::size_t>(count);
  }
  // Some file systems cannot synchronise; a disk that fails says EIO or ENOSPC.
  if (::fdatasync(descriptor) != 0 && errno != EINVAL && errno != ENOTSUP) fail(errno);
  return end;
}

}  // namespace

std::string hash_key(std::string_view canonical) {
  std::uint64_t hash = 14695981039346656037U;  // FNV-1a
  for (const char c : canonical) hash = (hash ^ static_cast<unsigned char>(c)) * 1099511628211U;
  return fmt::format("{:016x}", hash);
}

RowFile::RowFile(const std::filesystem::path& folder, std::vector<std::string> columns, bool keep)
    : jsonl_path_(folder / "runs.jsonl"), csv_path_(folder / "runs.csv"), columns_(std::move(columns)) {
  std::string jsonl;
  if (keep) {
    std::ifstream file(jsonl_path_);
    for (std::string line; std::getline(file, line);) {
      Json row = Json::parse(line, nullptr, false);
      // Cut off by a crash, or no row: that run is done again.
      if (!row.is_object() || !row.contains("key") || !row["key"].is_string()) continue;
      keys_.insert(row["key"].get<std::string>());
      rows_.push_back(std::move(row));
      jsonl += line + '\n';
    }
  }
  std::string csv;
  for (const auto& column : columns_) csv += (csv.empty() ? "" : ",") + csv_cell(column);
  csv += '\n';
  for (const auto& row : rows_) csv += csv_line(row);
  write_atomically(jsonl_path_, jsonl);
  write_atomically(csv_path_, csv);
  jsonl_ = open_for_append(jsonl_path_);
  csv_ = open_for_append(csv_path_);
}

RowFile::~RowFile() {
  ::close(jsonl_);
  ::close(csv_);
}

std::string RowFile::csv_line(const Json& row) const {
  const auto cells = flatten(row);
  std::string line;
  for (std::size_t i = 0; i < columns_.size(); ++i) {
    const auto cell = cells.find(columns_[i]);
    if (i > 0) line += ',';
    if (cell != cells.end()) line += csv_cell(cell->second);
  }
  return line + '\n';
}

void RowFile::append(const Json& row) {
  const off_t begin = append_line(jsonl_, jsonl_path_, row.dump() + '\n');
  try {
    append_line(csv_, csv_path_, csv_line(row));
  } catch (...) {
    cut_back(jsonl_, begin);
    throw;
  }
  keys_.insert(row["key"].get<std::string>());
  rows_.push_back(row);
}

}  // namespace abn::harness
