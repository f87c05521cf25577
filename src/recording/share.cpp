#include "recording/share.h"

#include <algorithm>

#include "core/error.h"
#include "recording/recover.h"
#include "scenario/yaml_tree.h"

namespace predictor {
namespace {

// Labels that describe the run and not the person.
constexpr const char* kConditionLabel = "condition";

bool IsTrue(const YamlNode* node) { return node != nullptr && node->text == "true"; }

}  // namespace

std::vector<std::string> RemovePerson(RecordingHeader* header) {
  std::vector<std::string> removed;
  if (!header->scenario_yaml.empty()) {
    YamlNode root = ParseYaml(header->scenario_yaml, "scenario");
    if (YamlNode* person = root.Find("operator")) {
      if (IsTrue(person->Find("embodied")))
        throw InputError(
            "The operator was simulated with this body (operator.embodied). The run cannot be "
            "repeated without this body. Share the recording unchanged, because this body does not "
            "describe a real person.");
      std::erase_if(person->items, [&](const YamlNode& item) {
        const bool personal = item.key == "body" || item.key == "stance";
        if (personal && item.kind != YamlNode::Kind::kNull)
          removed.push_back("operator." + item.key);
        return personal;
      });
    }
    header->scenario_yaml = WriteYaml(root);
  }
  std::erase_if(header->labels, [&](const auto& label) {
    if (label.first == kConditionLabel) return false;
    removed.push_back("label " + label.first);
    return true;
  });
  return removed;
}

std::vector<std::string> WriteShared(const std::string& in, const std::string& out) {
  std::vector<std::string> removed;
  Rewriting rewriting;
  rewriting.change = [&](RecordingHeader* header) { removed = RemovePerson(header); };
  rewriting.person = false;
  const RecoverReport report = Recover(in, out, nullptr, rewriting);
  if (report.left_out_markers > 0)
    removed.push_back(std::to_string(report.left_out_markers) + " markers");
  if (report.left_out_states > 0)
    removed.push_back(std::to_string(report.left_out_states) + " states of the person");
  if (report.left_out_heads > 0)
    removed.push_back(std::to_string(report.left_out_heads) + " measured poses of the head");
  if (report.left_out_samples > 0)
    removed.push_back(std::to_string(report.left_out_samples) +
                      " messages of other systems' measurements");
  return removed;
}

}  // namespace predictor
