// A parameter that is one of a few words.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "sampling/params.h"

namespace abn {

/// The field of an enumeration: a string with its choices.
template <class P>
Field<P> choice_field(std::string name, std::string P::*member, std::string help, std::vector<std::string> choices) {
  Field<P> field{std::move(name), member, std::move(help)};
  field.choices = std::move(choices);
  return field;
}

}  // namespace abn
