// What must be known to repeat a number: the reproducibility record, and the JSON form of a run.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "harness/run.h"

namespace abn::harness {

using Json = nlohmann::ordered_json;

struct Reliability;

/// {"version","revision","build_type","compiler","cpu","gpu","libraries":{…}}: of this program on this machine.
const Json& reproducibility_record();

/// The object that `abn downscale --json` prints and `runs.jsonl` holds; an undefined score is null, and so is
/// "estimated_rmse" where the reconstruction estimates no errors.
Json to_json(const RunResult& result);

/// {"rmse_ratio","worst_bin_factor","log2_deviation"}: how good the error estimates of a run are; null where undefined.
Json to_json(const Reliability& curve);

/// [{"name","value","text","warning"}], the last two only where there is one.
Json to_json(const std::vector<Diagnostic>& diagnostics);

/// Nested keys joined by dots ("scores.rmse"), arrays as JSON text: one level, for CSV.
std::map<std::string, std::string> flatten(const Json& json);

/// A CSV cell, quoted where RFC 4180 wants it.
std::string csv_cell(const std::string& text);

}  // namespace abn::harness
