// The result files of an experiment: runs.jsonl (one JSON object a line) and runs.csv (the same, dotted keys).
#pragma once

#include <cstdio>
#include <filesystem>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "harness/record.h"

namespace abn::harness {

/// 16 hexadecimal digits that stand for a canonical spec: the key of a row.
std::string hash_key(std::string_view canonical);

/// Rows that survive anything: each is appended in one write and flushed to the disk before the next run starts; a
/// line cut off by a crash is dropped when the file is opened again.
class RowFile {
 public:
  /// Opens `folder`/runs.jsonl and runs.csv; with `keep` the rows already there stay, else both start empty.
  /// `columns` are the CSV's dotted keys. Throws IoError.
  RowFile(const std::filesystem::path& folder, std::vector<std::string> columns, bool keep);
  ~RowFile();
  RowFile(const RowFile&) = delete;
  RowFile& operator=(const RowFile&) = delete;

  const std::vector<Json>& rows() const { return rows_; }
  bool has(const std::string& key) const { return keys_.contains(key); }
  /// Appends a row to both files. Throws IoError; then the row is in neither (what was written of it is cut off).
  void append(const Json& row);

 private:
  std::string csv_line(const Json& row) const;

  std::filesystem::path jsonl_path_;
  std::filesystem::path csv_path_;
  std::vector<std::string> columns_;
  std::vector<Json> rows_;
  std::set<std::string> keys_;
  int jsonl_ = -1;
  int csv_ = -1;
};

}  // namespace abn::harness
