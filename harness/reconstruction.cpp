#include "harness/reconstruction.h"

#include "harness/density_reconstruction.h"
#include "harness/edge_reconstruction.h"
#include "harness/kriging.h"
#include "harness/standard_error.h"
#include "harness/voronoi_reconstruction.h"
#include "sampling/error.h"

namespace abn::harness {
namespace {

Developed mean(const Film& film) {
  Developed developed = film.develop();
  developed.standard_error = independent_standard_error(film.stats());
  return developed;
}

}  // namespace

const std::vector<Reconstruction>& reconstructions() {
  static const std::vector<Reconstruction> table = {
      {"mean", "the mean of each pixel's samples by their actual number", mean, false},
      {"density", "the mean of each pixel's samples, each weighted by the inverse of the sample density around it",
       density_weighted},
      {"voronoi", "samples weighted by the area of their Voronoi cells inside the pixel", voronoi},
      {"kriging", "the best linear unbiased estimate of the pixel's integral from the samples in and near it", kriging},
      {"edge", "kriging after a straight step has been found in the pixel's samples and integrated by itself", edge},
      {"kriging_tonemapped", "kriging of x/(1+x), then inverted: bounds fireflies, darkens edges of lights",
       kriging_tonemapped},
  };
  return table;
}

const Reconstruction& find_reconstruction(std::string_view name) {
  std::string known = "auto";
  for (const auto& row : reconstructions()) {
    if (row.name == name) return row;
    known += ", " + row.name;
  }
  throw ConfigError("reconstruction '" + std::string(name) + "' is unknown; known: " + known);
}

}  // namespace abn::harness
