// The person in a study who holds the handles. These data contain only what a study may store, and
// no name. A recording contains these data as labels.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>

#include "scenario/problems.h"
#include "scenario/scenario.h"
#include "scenario/yaml_tree.h"

namespace predictor {

// The consent of the person.
struct ConsentSpec {
  std::string version;  // of the text of the consent
  std::string date;     // on which the person signed it: YYYY-MM-DD
};

struct ParticipantSpec {
  std::string pseudonym;  // IsPseudonym
  ConsentSpec consent;
  std::string handedness = "unknown";  // unknown | left | right | ambidextrous
};

// The file that the option --participant names.
struct ParticipantFile : ParticipantSpec {
  std::optional<BodySpec> body;  // absent: as the scenario says
};

// Throws InputError with file:line:column.
ParticipantFile LoadParticipant(const std::filesystem::path& file);
// Returns "operator.body=...", for LoadScenario.
std::string BodyOverride(const BodySpec& body);

// Reports a pseudonym that IsPseudonym refuses (such as a name), a consent without a version, and a
// day that does not exist. `path` ends with a dot, or is empty.
void CheckParticipant(const ParticipantSpec& participant, const std::string& path,
                      const YamlNode& root, Problems* problems);

// Returns the labels of a recording that are reserved for the participant, and their values.
std::map<std::string, std::string> LabelsOf(const ParticipantSpec& participant);
bool IsParticipantLabel(const std::string& key);
// Returns the participant from all labels of a recording, or nothing without a pseudonym.
std::optional<ParticipantSpec> ParticipantIn(const std::map<std::string, std::string>& labels);

// Returns a description of the participant, such as "participant K7QM2XPX, consent study-2 of
// 2026-11-20, left-handed".
std::string ParticipantWords(const ParticipantSpec& participant);

}  // namespace predictor
