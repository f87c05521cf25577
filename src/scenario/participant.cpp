#include "scenario/participant.h"

#include <algorithm>
#include <array>
#include <chrono>

#include "core/error.h"
#include "core/text.h"
#include "scenario/field_reader.h"
#include "scenario/field_writer.h"
#include "scenario/participant_fields.h"
#include "scenario/pseudonym.h"

namespace predictor {
namespace {

constexpr std::size_t kLongestVersion = 40;  // [characters]
constexpr const char* kPseudonymLabel = "pseudonym";
constexpr const char* kConsentLabel = "consent";
constexpr const char* kConsentDateLabel = "consent_date";
constexpr const char* kHandednessLabel = "handedness";

// Returns whether a text is a day of the calendar as YYYY-MM-DD.
bool IsDate(const std::string& text) {
  constexpr std::string_view kPattern = "dddd-dd-dd";
  const auto fits = [](char c, char pattern) {
    return pattern == 'd' ? c >= '0' && c <= '9' : c == pattern;
  };
  if (!std::equal(text.begin(), text.end(), kPattern.begin(), kPattern.end(), fits)) return false;
  return std::chrono::year_month_day(
             std::chrono::year(std::stoi(text.substr(0, 4))),
             std::chrono::month(static_cast<unsigned>(std::stoi(text.substr(5, 2)))),
             std::chrono::day(static_cast<unsigned>(std::stoi(text.substr(8, 2)))))
      .ok();
}

bool IsVersion(const std::string& text) {
  return !text.empty() && text.size() <= kLongestVersion &&
         std::ranges::all_of(text, [](char c) { return c >= ' ' && c <= '~' && c != '@'; });
}

}  // namespace

ParticipantFile LoadParticipant(const std::filesystem::path& file) {
  const YamlNode root = ParseYaml(ReadYamlText(file, "a participant's file"), file.string());
  if (root.kind != YamlNode::Kind::kMap)
    throw InputError(root.place.Text(),
                     "a participant's file must be a group of keys, but this is " + Describe(root) +
                         ". Begin with \"pseudonym:\".");
  Problems problems;
  auto participant = ReadStruct<ParticipantFile>(root, &problems);
  problems.ThrowIfAny();
  CheckParticipant(participant, "", root, &problems);
  problems.ThrowIfAny();
  return participant;
}

std::string BodyOverride(const BodySpec& body) {
  return "operator.body=\n" + WriteYaml(WriteStruct(body));
}

std::map<std::string, std::string> LabelsOf(const ParticipantSpec& participant) {
  return {{kPseudonymLabel, participant.pseudonym},
          {kConsentLabel, participant.consent.version},
          {kConsentDateLabel, participant.consent.date},
          {kHandednessLabel, participant.handedness}};
}

bool IsParticipantLabel(const std::string& key) {
  return LabelsOf(ParticipantSpec()).contains(key);
}

std::optional<ParticipantSpec> ParticipantIn(const std::map<std::string, std::string>& labels) {
  const auto value = [&](const char* key) {
    const auto found = labels.find(key);
    return found == labels.end() ? std::string() : found->second;
  };
  ParticipantSpec participant;
  participant.pseudonym = value(kPseudonymLabel);
  if (participant.pseudonym.empty()) return {};
  participant.consent = {value(kConsentLabel), value(kConsentDateLabel)};
  if (labels.contains(kHandednessLabel)) participant.handedness = value(kHandednessLabel);
  return participant;
}

std::string ParticipantWords(const ParticipantSpec& participant) {
  std::string words = "participant " + participant.pseudonym + ", consent " +
                      participant.consent.version + " of " + participant.consent.date;
  if (participant.handedness == "ambidextrous") return words + ", ambidextrous";
  if (participant.handedness != "unknown") words += ", " + participant.handedness + "-handed";
  return words;
}

void CheckParticipant(const ParticipantSpec& participant, const std::string& path,
                      const YamlNode& root, Problems* problems) {
  const auto unless = [&](bool good, const std::string& key, const std::string& sentence) {
    if (!good) problems->Add(PlaceOf(path + key, root), path + key + " " + sentence);
  };
  unless(
      IsPseudonym(participant.pseudonym), "pseudonym",
      "is " + Quote(participant.pseudonym) +
          ", but it must be eight characters (digits 2 to 9, capital letters except I and O), of "
          "which the last one checks the others, and must not describe the person. `predictor "
          "pseudonym` draws one. If you already have a pseudonym, check it for typing errors.");
  unless(IsVersion(participant.consent.version), "consent.version",
         "is " + Quote(participant.consent.version) +
             ". Give the version of the text to which the person agreed, in at most 40 ASCII "
             "characters, for example study-2.");
  unless(IsDate(participant.consent.date), "consent.date",
         "is " + Quote(participant.consent.date) +
             ", which is not a date. Write it as YYYY-MM-DD, for example 2026-11-20.");
}

}  // namespace predictor
