// The table of strategies: one row per way to place samples. Program, tests, benchmarks and `abn list` read it.
#pragma once

#include <concepts>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "sampling/params.h"
#include "sampling/sampler.h"

namespace abn {

/// What a person wants to know of a strategy; every strategy class has one as `static const StrategyInfo info`.
struct StrategyInfo {
  std::string name;     // as typed: letters, digits, underscores
  std::string family;   // baseline | stratified | low discrepancy | blue noise | adaptive | filter importance | outside
  std::string summary;  // what it is, one sentence
  std::string cite;     // whom to cite
  std::string advice;   // when to use it, one sentence
  std::vector<std::string> aliases = {};
  bool adaptive = false;                // reads its Feedback
  std::string reconstruction = "mean";  // what `--reconstruction auto` means for it
  std::string reconstruction_hdr = {};  // likewise where values may be far above 1; empty = the same
  bool random = true;                   // another seed gives other samples
  bool density = false;                 // places its samples by SamplingTask::density
  bool filter = false;                  // draws its samples from SamplingTask::filter, so that their mean is filtered
  bool solver = false;                  // relaxes particles by SamplingTask::solver
};

/// A row of the table.
struct Strategy {
  StrategyInfo info;
  std::vector<FieldDescription> parameters;
  /// Throws ConfigError for bad words or a budget the method cannot meet (naming the nearest ones), IoError for files.
  std::function<std::unique_ptr<Sampler>(const SamplingTask&, const ParameterWords&)> make;
  /// Validates words without building a sampler; returns every parameter's value. Throws ConfigError.
  std::function<ParameterWords(const ParameterWords&)> resolve;
};

/// What a class must offer to become a row.
template <class T>
concept StrategyClass = std::derived_from<T, Sampler> &&
    std::constructible_from<T, const SamplingTask&, const typename T::Params&> && requires {
  { T::info } -> std::convertible_to<const StrategyInfo&>;
  { T::fields() } -> std::same_as<std::vector<Field<typename T::Params>>>;
};

/// Throws ConfigError for a task that no strategy can do: no samples, or a plane without pixels.
void require_task(std::string_view strategy, const SamplingTask& task);

template <StrategyClass T>
Strategy row() {
  Strategy strategy;
  strategy.info = T::info;
  strategy.parameters = describe_fields(T::fields());
  strategy.make = [](const SamplingTask& task, const ParameterWords& words) -> std::unique_ptr<Sampler> {
    require_task(T::info.name, task);
    return std::make_unique<T>(task, parse_parameters(T::info.name, T::fields(), words));
  };
  strategy.resolve = [](const ParameterWords& words) {
    return echo_parameters(T::fields(), parse_parameters(T::info.name, T::fields(), words));
  };
  return strategy;
}

/// The table, in the order of `abn list`.
const std::vector<Strategy>& strategies();

/// A strategy as the user names it: a row's name or alias, `file:PATH` or `command:CMD` (then `words` gains the
/// path or the command). Throws ConfigError that lists what is known.
const Strategy& find_strategy(std::string_view name, ParameterWords& words);

}  // namespace abn
