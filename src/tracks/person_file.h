// Imports recordings of a person from another system. The recordings contain the motions and forces
// of the hands, and all other data that are needed to judge the person. Such a recording is a table
// with named columns (MapOfColumns) at 100 Hz. Comments with a few keys in YAML precede the table.
// This format differs from a recording of the emulator, because it has no ticks.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "scenario/participant.h"
#include "scenario/scenario.h"
#include "tracks/body_track.h"
#include "tracks/track_map.h"

namespace predictor::tracks {

struct PersonHeader {
  int format = 1;
  std::string name;                   // name of the task
  std::string source;                 // file from which it was imported
  bool simulated = false;             // a simulation, and no person, held the handles
  std::optional<double> object_mass;  // moved by the hands together with a robot [kg]
  std::optional<BodySpec> body;
  std::optional<StanceSpec> stance;
  std::optional<ParticipantSpec> participant;
  GripSpec left, right;            // how the hands hold their handles
  std::vector<std::string> notes;  // sentences about what was missing
};

struct PersonFile {
  PersonHeader header;
  BodyTrack track;  // hands with poses and wrenches; possibly head, elbows and signals
};

inline constexpr double kPersonRate = 100;  // rows [Hz]

// A mapping for `predictor import`. It is a TrackMap without the name of the file, together with
// the header's keys.
struct ImportMap {
  TrackMap channels;
  PersonHeader person;
};

// Throws InputError with file:line:column.
ImportMap ParseImportMap(const std::string& text, const std::string& name);

// Returns the text of a recording of a person. Throws InputError if a hand, its rotation or its
// force is missing, or if there is no period in which all these quantities are measured. The
// message names the missing part. Forces are means over 10 ms. If a pose or force is missing for
// more than PartTrack::kMaxGap, the hand is treated as not holding its handle. The header states
// the total time for which this is the case.
std::string ImportPerson(const ImportMap& map, const SeriesFile& file);

bool IsPersonFile(const std::filesystem::path& file);
// `overrides` are texts "key=value" with keys of the header. Throws InputError.
PersonFile ReadPersonFile(const std::filesystem::path& file,
                          const std::vector<std::string>& overrides = {});

}  // namespace predictor::tracks
