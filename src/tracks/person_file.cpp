#include "tracks/person_file.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <sstream>

#include "core/error.h"
#include "core/format.h"
#include "core/text.h"
#include "scenario/field_reader.h"
#include "scenario/field_writer.h"
#include "scenario/participant_fields.h"
#include "tracks/read_map.h"
#include "tracks/track_map_fields.h"

namespace predictor::tracks {
namespace {

constexpr const char* kFirstLine = "# predictor_person: 1";

}  // namespace

template <class V>
void PersonFields(V& v, PersonHeader& s) {
  v("name", s.name, Word("name of the task"));
  v("source", s.source, Word("file from which it was imported"));
  v("simulated", s.simulated, Flag("whether a simulation, and no person, held the handles"));
  v("object_mass", s.object_mass,
    Number("kg", "mass of the object that the hands move together with a robot", Above(0, 1000)));
  v.Group("operator", "the person", [&](auto& inner) {
    inner("body", s.body, Part("height, mass and sex"));
    inner("stance", s.stance, Part("where the person stands, in W"));
  });
  v("participant", s.participant, Part("the person in a study; null: none"));
  v.Group("grips", "how the hands hold their handles", [&](auto& inner) {
    inner("left", s.left, Part("the left hand"));
    inner("right", s.right, Part("the right hand"));
  });
  v("notes", s.notes, List(Word("what was missing"), 0, 64));
}

template <class V>
void Fields(V& v, PersonHeader& s) {
  v("predictor_person", s.format, Required(Number("", "version of the format", From(1, 1))));
  PersonFields(v, s);
}

template <class V>
void Fields(V& v, ImportMap& s) {
  TrackFields(v, s.channels);
  PersonFields(v, s.person);
}

namespace {

void Require(bool given, const std::string& key, const std::string& why, const Place& place,
             Problems* problems) {
  if (!given) problems->Add(place, key + " is missing: " + why);
}

void CheckHeader(const PersonHeader& header, const YamlNode& root, Problems* problems) {
  if (header.participant) CheckParticipant(*header.participant, "participant.", root, problems);
}

void CheckImport(const ImportMap& map, const YamlNode& root, Problems* problems) {
  CheckTrackMap(map.channels, root, problems);
  CheckHeader(map.person, root, problems);
  const auto check = [&](const std::optional<HandMap>& hand, const std::string& name) {
    if (!hand) return;
    const Place place = PlaceOf(name, root);
    Require(!hand->rotation.empty() || !hand->front.empty(), name + ".rotation",
            "without the rotation of the handle, the angles of the wrist are not known.", place,
            problems);
    Require(!hand->force.empty(), name + ".force",
            "without the force of the hand, no load of the body is known.", place, problems);
  };
  check(map.channels.left_hand, "left_hand");
  check(map.channels.right_hand, "right_hand");
  if (!map.channels.emg.empty())
    problems->Add(
        PlaceOf("emg", root),
        "emg has more values per second than the table that an import makes. Remove it from this "
        "mapping, and give it to predictor evaluate in another mapping with --track.");
  Require(map.channels.left_hand || map.channels.right_hand, "left_hand or right_hand",
          "give the pose of the handle and the force of at least one hand.", root.place, problems);
}

// ---- writing ----------------------------------------------------------------------------------

// The columns of the table, and the cells of these columns at one time.
class Table {
 public:
  Table(const BodyTrack& track, double start) : track_(track), start_(start) {}

  std::string Head() const {
    std::string text = "time [s]";
    for (std::size_t h = 0; h < kHands; ++h) {
      if (!track_.hands[h]) continue;
      const std::string name = std::string(kHandNames[h]) + "_hand";
      text += Columns(name, ".p", " [m]") + Quaternion4(name) + Columns(name, ".force", " [N]") +
              Columns(name, ".torque", " [N m]") + "," + name + ".holds";
    }
    if (track_.head)
      text += Columns("head", ".p", " [m]") + (track_.head->q.empty() ? "" : Quaternion4("head"));
    for (std::size_t h = 0; h < kHands; ++h)
      if (track_.elbows[h]) text += Columns(std::string(kHandNames[h]) + "_elbow", ".p", " [m]");
    for (const SignalTrack& signal : track_.signals)
      text += "," + CsvCell(signal.name + (signal.unit.empty() ? "" : " [" + signal.unit + "]"));
    return text + "\n";
  }

  // `k` is the row.
  std::string Row(std::size_t k) {
    const double time = start_ + static_cast<double>(k) / kPersonRate;
    text_ = Formatted("%.2f", static_cast<double>(k) / kPersonRate);
    for (std::size_t h = 0; h < kHands; ++h)
      if (track_.hands[h]) AddHand(h, time);
    if (track_.head) {
      Add(track_.head->PositionAt(time));
      if (!track_.head->q.empty()) Add(track_.head->RotationAt(time));
    }
    for (const auto& elbow : track_.elbows)
      if (elbow) Add(elbow->PositionAt(time));
    for (const SignalTrack& signal : track_.signals) Add(signal.At(time, 1 / kPersonRate));
    return text_ + "\n";
  }

  // Returns the number of rows in which a hand was not measured.
  const std::array<std::size_t, kHands>& missing() const { return missing_; }

 private:
  static std::string Columns(const std::string& name, const char* what, const char* unit) {
    std::string text;
    for (const char* axis : {".x", ".y", ".z"}) text += "," + name + what + axis + unit;
    return text;
  }
  static std::string Quaternion4(const std::string& name) {
    return "," + name + ".q.w" + Columns(name, ".q", "");
  }

  void AddHand(std::size_t h, double time) {
    const HandTrack& hand = *track_.hands[h];
    auto p = hand.pose.PositionAt(time);
    auto q = hand.pose.RotationAt(time);
    auto F = hand.WrenchAt(time, 1 / kPersonRate);
    const bool measured = p && q && F;
    if (!measured) {
      ++missing_[h];
      p.reset();
      q.reset();
      F.reset();
    }
    Add(p);
    Add(q);
    Add(F ? std::optional<Vector3>(F->head<3>()) : std::nullopt);
    Add(F ? std::optional<Vector3>(F->tail<3>()) : std::nullopt);
    text_ += measured && hand.HoldsAt(time) ? ",1" : ",0";
  }
  void Add(double x) { text_ += std::isfinite(x) ? Formatted(",%.9g", x) : ","; }
  void Add(const std::optional<Vector3>& v) {
    for (int i = 0; i < 3; ++i) Add(v ? (*v)[i] : kMissing);
  }
  void Add(const std::optional<Quaternion>& q) {
    Add(q ? q->w() : kMissing);
    Add(q ? std::optional<Vector3>(q->vec()) : std::nullopt);
  }

  const BodyTrack& track_;
  double start_;
  std::string text_;
  std::array<std::size_t, kHands> missing_ = {};
};

struct Span {
  double begin = -INFINITY, end = INFINITY;
};

// Returns the period in which the poses and forces of all hands are measured. Throws InputError if
// there is no such period.
Span CommonSpan(const BodyTrack& track) {
  Span span;
  const auto meet = [&](const std::vector<double>& times, const std::string& what) {
    constexpr double kShortest = 0.1;  // [s]
    if (std::max(span.begin, times.front()) + kShortest > std::min(span.end, times.back()))
      throw InputError(
          track.source,
          Formatted(
              "%s is measured from %.3f to %.3f s, and the others from %.3f to "
              "%.3f s. They are never all measured at the same time. Perhaps their clocks differ.",
              what.c_str(), times.front(), times.back(), span.begin, span.end));
    span = {std::max(span.begin, times.front()), std::min(span.end, times.back())};
  };
  for (std::size_t h = 0; h < kHands; ++h) {
    if (!track.hands[h]) continue;
    const std::string name = std::string(kHandNames[h]) + "_hand";
    meet(track.hands[h]->pose.times, name + "'s pose");
    meet(track.hands[h]->wrench_times, name + "'s force");
  }
  return span;
}

void RemoveComments(YamlNode* node) {
  node->comment.clear();
  for (YamlNode& item : node->items) RemoveComments(&item);
}

std::string CommentsOf(const PersonHeader& header) {
  YamlNode tree = WriteStruct(header);
  RemoveComments(&tree);
  std::istringstream lines(WriteYaml(tree));
  std::string text;
  for (std::string line; std::getline(lines, line);) text += "# " + line + "\n";
  return text;
}

}  // namespace

ImportMap ParseImportMap(const std::string& text, const std::string& name) {
  return ReadMap<ImportMap>(text, name, "left_hand:", CheckImport);
}

std::string ImportPerson(const ImportMap& map, const SeriesFile& file) {
  const BodyTrack track = ApplyMap(map.channels, file);
  const Span span = CommonSpan(track);
  const auto rows = static_cast<std::size_t>((span.end - span.begin) * kPersonRate) + 1;
  constexpr std::size_t kMaxRows = 10'000'000;
  if (rows > kMaxRows)
    throw InputError(file.name, "The file is longer than a day. Import only a part of the file.");
  Table table(track, span.begin);
  std::string text = table.Head();
  for (std::size_t k = 0; k < rows; ++k) text += table.Row(k);
  PersonHeader header = map.person;
  header.source = std::filesystem::path(file.name).filename().string();
  if (header.name.empty()) header.name = std::filesystem::path(file.name).stem().string();
  for (std::size_t h = 0; h < kHands; ++h) {
    const auto& hand = h == 0 ? map.channels.left_hand : map.channels.right_hand;
    if (!hand) continue;
    const std::string name = std::string("The ") + kHandNames[h] + " hand: ";
    if (hand->torque.empty())
      header.notes.push_back(name + "its torque was not measured and counts as zero.");
    if (table.missing()[h] == rows)
      throw InputError(file.name, name + "pose and force are never measured together.");
    if (table.missing()[h] > 0)
      header.notes.push_back(name + Formatted("pose or force are missing for %.1f %% of the time, "
                                              "which counts as not holding.",
                                              100 * static_cast<double>(table.missing()[h]) /
                                                  static_cast<double>(rows)));
  }
  for (const std::string& warning : file.warnings) header.notes.push_back(Printable(warning));
  return CommentsOf(header) + text;
}

bool IsPersonFile(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::string line;
  return std::getline(in, line) && line.starts_with(kFirstLine);
}

PersonFile ReadPersonFile(const std::filesystem::path& file,
                          const std::vector<std::string>& overrides) {
  const SeriesFile table = ReadCsv(file);
  std::string yaml;
  for (const std::string& comment : table.comments)
    yaml += (comment.starts_with(' ') ? comment.substr(1) : comment) + "\n";
  YamlNode root = ParseYaml(yaml, file.string());
  for (const std::string& assignment : overrides) ApplyOverride(assignment, &root);
  Problems problems;
  PersonFile person;
  person.header = ReadStruct<PersonHeader>(root, &problems);
  problems.ThrowIfAny();
  CheckHeader(person.header, root, &problems);
  problems.ThrowIfAny();
  person.track = ApplyMap(MapOfColumns(table), table);
  const auto& hands = person.track.hands;
  if (!hands[0] && !hands[1])
    throw InputError(file.string(), "The file has no columns of a hand. Import the data again.");
  for (const auto& hand : hands)
    if (hand && (hand->pose.q.empty() || hand->F.empty()))
      throw InputError(file.string(), "A hand has no rotation or no force. Import the data again.");
  const std::vector<double>& times = hands[0] ? hands[0]->pose.times : hands[1]->pose.times;
  for (std::size_t i = 1; i < times.size(); ++i)
    if (std::abs(times[i] - times[i - 1] - 1 / kPersonRate) > 1e-4)
      throw InputError(file.string(), Formatted("The rows at %.3f and %.3f s are not 0.01 s apart. "
                                                "Import the data again.",
                                                times[i - 1], times[i]));
  return person;
}

}  // namespace predictor::tracks
