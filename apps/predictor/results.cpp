#include "results.h"

#include <algorithm>
#include <cmath>

#include "commands.h"
#include "core/error.h"
#include "core/format.h"
#include "screen.h"

namespace predictor {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kMaxReported = 600;  // reading longer recordings would delay the page [s]

double Norm(const double* v) { return std::hypot(v[0], v[1], v[2]); }

// Three digits are enough on a screen and keep the message short.
double Rounded(double x) {
  if (x == 0 || !std::isfinite(x)) return 0;
  const double scale = std::pow(10, 2 - std::floor(std::log10(std::abs(x))));
  return std::round(x * scale) / scale;
}

std::string Time(double seconds) {
  if (seconds < 60) return Formatted("%.1f s", seconds);
  const long whole = std::lround(seconds);
  return Formatted("%ld min %02ld s", whole / 60, whole % 60);
}

// A row with one value for each existing hand. The values come from the results PREFIX.left.KEY and
// PREFIX.right.KEY.
struct HandsRow {
  const char* name;
  const char* prefix;
  const char* key;
  double (Statistics::*value)() const;
  int decimals;
};
constexpr HandsRow kHandsRows[] = {
    {"Largest force", "wrench.", ".force_n", &Statistics::max, 1},
    {"Largest torque", "wrench.", ".torque_nm", &Statistics::max, 2},
    {"Mean tracking error", "tracking.whole_run.", ".translation_m", &Statistics::mean, 2},
    {"Largest tracking error", "tracking.whole_run.", ".translation_m", &Statistics::max, 1},
};

std::string Millimetres(double length) { return Formatted("%.0f mm", 1e3 * length); }

// Adds what became of the cobot's grip, if the grip ever opened or slipped.
void AddGripper(const Summary& s, Json* rows) {
  const double open = s.Get<double>("gripper.open_s"),
               slipping = s.Get<double>("gripper.slipping_s");
  if (open + slipping == 0) return;
  rows->push_back(
      {{"name", "Gripper at the end"}, {"value", s.Get<std::string>("gripper.at_end")}});
  if (open > 0) rows->push_back({{"name", "Gripper open for"}, {"value", Time(open)}});
  if (slipping > 0) rows->push_back({{"name", "Gripper slipped for"}, {"value", Time(slipping)}});
}

Json Figures(const Summary& s) {
  Json rows = Json::array();
  rows.push_back({{"name", "Duration"}, {"value", Time(s.duration())}});
  if (s.ticks() == 0) return rows;
  for (const HandsRow& row : kHandsRows) {
    rows.push_back({{"name", row.name}});
    for (const char* hand : kHandNames) {
      const Result& result = s.At(std::string(row.prefix) + hand + row.key);
      if (IsMissing(result.value)) continue;
      rows.back()[hand] =
          Formatted("%.*f %s", row.decimals,
                    result.unit.factor * (std::get<Statistics>(result.value).*row.value)(),
                    result.unit.shown);
    }
  }
  const double lowered =
      s.Get<double>("object.height_m.initial") - s.Get<double>("object.height_m.min");
  rows.push_back(
      {{"name", "Object lifted by"}, {"value", Millimetres(s.Get<double>("object.lift_m"))}});
  rows.push_back({{"name", "Object lowered by"}, {"value", Millimetres(lowered)}});
  if (const Result& moved = s.At("movables.moved_m"); !IsMissing(moved.value))
    rows.push_back({{"name", "Movable object moved by"},
                    {"value", Millimetres(std::get<double>(moved.value))}});
  AddGripper(s, &rows);
  rows.push_back({{"name", "Late cycles"},
                  {"value", Formatted("%llu of %llu", static_cast<unsigned long long>(s.overruns),
                                      static_cast<unsigned long long>(s.ticks()))}});
  return rows;
}

}  // namespace

ResultCurves::ResultCurves(const Scenario& scenario)
    : present_{scenario.Has(0), scenario.Has(1)},
      force_limit_(scenario.safety.force),
      distance_limit_(scenario.safety.tracking) {
  pieces_.reserve(kPieces);
}

void ResultCurves::Add(const TickRecord& record) {
  if (record.run_time < time_) pieces_.clear();
  time_ = record.run_time;
  if (record.state != RunState::kRun) return;
  auto index = static_cast<std::size_t>(time_ / step_);
  while (index >= kPieces) {
    Halve();
    index = static_cast<std::size_t>(time_ / step_);
  }
  if (pieces_.size() <= index) pieces_.resize(index + 1);
  Piece& piece = pieces_[index];
  for (std::size_t h = 0; h < kHands; ++h) {
    const HandRecord& hand = record.hands[h];
    if (hand.present == 0) continue;
    std::array<double, 3> apart{};
    for (std::size_t i = 0; i < apart.size(); ++i)
      apart[i] = hand.real.pose.p[i] - hand.virtual_.pose.p[i] - record.perturbation[i];
    piece.force[h] = std::max(piece.force[h], Norm(hand.wrench.data()));
    piece.distance[h] = std::max(piece.distance[h], Norm(apart.data()));
  }
}

// Merges each pair of neighbouring pieces into one piece.
void ResultCurves::Halve() {
  const std::size_t half = (pieces_.size() + 1) / 2;
  for (std::size_t k = 0; k < half; ++k) {
    Piece piece = pieces_[2 * k];
    if (2 * k + 1 < pieces_.size())
      for (std::size_t h = 0; h < kHands; ++h) {
        const Piece& other = pieces_[2 * k + 1];
        piece.force[h] = std::max(piece.force[h], other.force[h]);
        piece.distance[h] = std::max(piece.distance[h], other.distance[h]);
      }
    pieces_[k] = piece;
  }
  pieces_.resize(half);
  step_ *= 2;
}

Json ResultCurves::ToJson() const {
  const auto curve = [this](const char* title, const char* unit, double factor, double limit,
                            std::array<double, kHands> Piece::*values) {
    Json json = {{"title", title}, {"unit", unit}, {"limit", factor * limit}, {"step", step_}};
    for (std::size_t h = 0; h < kHands; ++h) {
      Json list = Json::array();
      for (const Piece& piece : pieces_) list.push_back(Rounded(factor * (piece.*values)[h]));
      json[kHandNames[h]] = present_[h] ? list : Json(nullptr);
    }
    return json;
  };
  return {curve("Force at the handles", "N", 1, force_limit_, &Piece::force),
          curve("Tracking error of the handles", "mm", 1e3, distance_limit_, &Piece::distance)};
}

Json ResultsJson(const Summary& summary, const ResultCurves& curves, const std::string& how,
                 const std::string& recording, const std::string& remark) {
  return {{"how", how},
          {"figures", Figures(summary)},
          {"curves", curves.ToJson()},
          {"recording", recording},
          {"remark", remark}};
}

std::filesystem::path WriteRunReport(const std::string& recording, double duration, bool force,
                                     std::string* remark) {
  if (recording.empty()) {
    *remark = "This run was not recorded, so there is no report.";
    return {};
  }
  if (duration > kMaxReported) {
    *remark =
        "The run was long, so the program made no report. To make it, run: predictor report " +
        recording;
    return {};
  }
  const std::filesystem::path file = std::filesystem::path(recording).replace_extension(".html");
  try {
    ReportOptions options;
    options.recordings = {recording};
    options.output = file.string();
    options.quiet = true;
    options.force = force;
    ReportCommand(options);
  } catch (const InputError& error) {
    *remark = std::string("The report could not be made: ") + error.what();
    return {};
  }
  TheScreen().Print("Report    " + file.string());
  return std::filesystem::absolute(file);
}

}  // namespace predictor
