#include "harness/reconstruction.h"

#include "sampling/error.h"

namespace abn::harness {

const std::vector<Reconstruction>& reconstructions() {
  static const std::vector<Reconstruction> table = {
      {"mean", "the mean of each pixel's samples by their actual number",
       [](const Film& film) { return film.develop(); }},
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
