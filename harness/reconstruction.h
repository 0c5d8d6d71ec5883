// The table of reconstructions: how the samples of a film become pixels.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "harness/film.h"
#include "harness/kriging.h"

namespace abn::harness {

/// How a row makes a picture of a film: a function of the film, or of that and what estimates pixels on a device.
class Develop {
 public:
  template <class Function>
  Develop(Function function) {  // implicit: a row is written with the function itself
    if constexpr (std::is_invocable_v<Function, const Film&, const EstimatePixels&>) {
      develop_ = std::move(function);
      runs_on_device_ = true;
    } else {
      develop_ = [function = std::move(function)](const Film& film, const EstimatePixels&) { return function(film); };
    }
  }
  /// on_device: null = the CPU; rows that estimate nothing there do not look at it.
  Developed operator()(const Film& film, const EstimatePixels& on_device = nullptr) const {
    return develop_(film, on_device);
  }
  bool runs_on_device() const { return runs_on_device_; }

 private:
  bool runs_on_device_ = false;
  std::function<Developed(const Film&, const EstimatePixels&)> develop_;
};

/// A row of the table. Samples of weight 0 count as evaluated and are looked at by no reconstruction.
struct Reconstruction {
  std::string name;     // as typed after --reconstruction
  std::string summary;  // one sentence
  Develop develop;
  bool needs_samples = true;  // the film has to keep them
};

/// The table, in the order of `abn list reconstructions`.
const std::vector<Reconstruction>& reconstructions();

/// The row of that name; throws ConfigError that lists what is known. ("auto" is no row: it means the name that the
/// strategy's row recommends.)
const Reconstruction& find_reconstruction(std::string_view name);

}  // namespace abn::harness
