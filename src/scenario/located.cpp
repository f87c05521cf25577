#include "scenario/located.h"

#include "scenario/yaml_tree.h"

namespace predictor {

InputError Located(const InputError& error, const Scenario& scenario) {
  if (error.key().empty() || scenario.tree == nullptr) return error;
  return {PlaceOf(error.key(), *scenario.tree).Text(), error.what()};
}

}  // namespace predictor
