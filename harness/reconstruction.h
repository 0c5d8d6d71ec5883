// The table of reconstructions: how the samples of a film become pixels.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "harness/film.h"

namespace abn::harness {

/// A row of the table. Samples of weight 0 count as evaluated and are looked at by no reconstruction.
struct Reconstruction {
  std::string name;     // as typed after --reconstruction
  std::string summary;  // one sentence
  std::function<Developed(const Film&)> develop;
  bool needs_samples = true;  // the film has to keep them
};

/// The table, in the order of `abn list reconstructions`.
const std::vector<Reconstruction>& reconstructions();

/// The row of that name; throws ConfigError that lists what is known. ("auto" is no row: it means the name that the
/// strategy's row recommends.)
const Reconstruction& find_reconstruction(std::string_view name);

}  // namespace abn::harness
