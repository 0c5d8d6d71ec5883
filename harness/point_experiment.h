// Runs an experiment on point sets: rows appended as they finish, pictures and a table at the end.
#pragma once

#include "harness/experiment.h"
#include "harness/point_metrics.h"
#include "harness/point_spec.h"
#include "harness/record.h"

namespace abn::harness {

/// One set, drawn and measured.
struct PointRunResult {
  PointRunSpec spec;
  DrawnPoints drawn;
  SetMeasures measures;
};

/// Draws and measures one set; `density` is that of the spec, loaded, or null. Throws as draw_points and measure do.
PointRunResult run(const PointRunSpec& spec, std::shared_ptr<const Grid<float>> density,
                   const std::vector<std::string>& metrics);

/// Leaves runs.jsonl, runs.csv, table.md and, with images, points/ and images/ in `out`. Throws as the other one does.
ExperimentOutcome run_experiment(const PointExperimentSpec& spec, const ExperimentOptions& options);

/// Markdown, one table per density and count, shaped for reading: one line per strategy: metrics as mean and half of
/// the 95 % interval over seeds.
std::string point_summary_table(const std::vector<Json>& rows, const std::vector<std::string>& metrics);

}  // namespace abn::harness
