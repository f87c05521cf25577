#include "assessment/output.h"
#include "assessment/safety/output.h"
#include "core/json_schema.h"
#include "core/text.h"

namespace predictor::assessment {
namespace {

using Json = nlohmann::ordered_json;

Json ToJson(const std::optional<person::Interval>& range) {
  if (!range) return nullptr;
  return {NumberOrNull(range->low), NumberOrNull(range->high)};
}

Json ToJson(const QuantityResult& q) {
  return {{"unit", q.kind->unit.si},
          {"origin", Name(q.kind->origin)},
          {"mean", NumberOrNull(q.mean)},
          {"p5", NumberOrNull(q.p5)},
          {"p95", NumberOrNull(q.p95)},
          {"min", NumberOrNull(q.min)},
          {"max", NumberOrNull(q.max)},
          {"bad", q.kind->bad == Bad::kHigh ? "high" : "low"},
          {"mean_interval_90", ToJson(q.mean_interval)},
          {"tail_interval_90", ToJson(q.tail_interval)}};
}

Json ToJson(const WorksheetResult& w) {
  Json classes = Json::array();
  for (std::size_t score = 1; score < w.share.size(); ++score)
    classes.push_back(
        {{"score", score},
         {"share_of_time", w.share[score]},
         {"probability", w.probability.empty() ? Json(nullptr) : Json(w.probability[score])}});
  return {{"origin", Name(Origin::kStandard)},
          {"worst", w.worst},
          {"p95", w.p95},
          {"action", w.kind->action(w.p95).sentence},
          {"classes", classes}};
}

Json ToJson(const ergonomics::HandPlace& place) {
  return {{"horizontal_m", place.horizontal},
          {"height_m", place.height},
          {"asymmetry_rad", place.asymmetry}};
}

Json OptionalNumber(const std::optional<double>& x) { return x ? Json(*x) : Json(nullptr); }

Json ToJson(const LiftingJob& job) {
  return {{"origin", Name(Origin::kStandard)},
          {"lifts", job.lifts},
          {"duration_min", job.minutes},
          {"adapted_composite_lifting_index", NumberOrNull(job.carried)},
          {"unassisted_composite_lifting_index", NumberOrNull(job.unassisted)}};
}

Json ToJson(const Lift& lift) {
  const bool no_index = lift.one_hand || lift.lowered;
  return {
      {"origin_of_number", Name(Origin::kStandard)},
      {"begin_s", lift.begin},
      {"end_s", lift.end},
      {"one_hand", lift.one_hand},
      {"lowered", lift.lowered},
      {"origin", ToJson(lift.origin)},
      {"destination", ToJson(lift.destination)},
      {"vertical_force_n", lift.vertical_force},
      {"adapted_lifting_index", no_index ? Json(nullptr) : NumberOrNull(lift.niosh.carried.index)},
      {"unassisted_lifting_index",
       no_index ? Json(nullptr) : NumberOrNull(lift.niosh.unassisted.index)},
      {"share_that_accepts",
       lift.one_hand || lift.acceptable.outside ? Json(nullptr) : Json(lift.share_that_accepts)},
      {"outside_lm_mmh", lift.acceptable.outside},
      {"lifft_moment_nm", OptionalNumber(lift.moment)},
      {"lifft_share_of_reference_day", OptionalNumber(lift.day_share)},
      {"outside_lifft", lift.outside_lifft()}};
}

Json ToJson(const DamageResult& d) {
  return {{"origin", Name(Origin::kStandard)},
          {"tool", d.tool},
          {"part", d.part},
          {"damage_per_run", d.per_run},
          {"share_of_reference_day_per_run", d.day_share},
          {"share_of_reference_day_per_shift", d.shift_share},
          {"probability_of_outcome", d.probability},
          {"outside_range", d.outside()}};
}

Json ToJson(const LimitResult& r) {
  return {{"origin", Name(Origin::kStandard)},
          {"edition", r.edition},
          {"clause", r.limit.clause},
          {"quantity", r.limit.kind ? r.limit.kind->path : ""},
          {"limit", r.limit.value},
          {"allowed_s", r.limit.allowed},
          {"verdict", Name(r.verdict)},
          {"worst", NumberOrNull(r.worst)},
          {"share_of_time_beyond", r.share},
          {"longest_s", r.longest},
          {"surely_longest_s", OptionalNumber(r.surely)},
          {"possibly_longest_s", OptionalNumber(r.possibly)}};
}

Json ToJson(const FatigueResult& f) {
  return {{"origin", Name(Origin::kModelled)},
          {"joint", f.joint},
          {"mean_load", f.mean_load},
          {"capacity_at_end", f.compartments.capacity},
          {"time_to_limit_s", NumberOrNull(f.compartments.time_to_limit)},
          {"ma_capacity_at_end", f.ma.capacity},
          {"ma_time_to_limit_s", NumberOrNull(f.ma.time_to_limit)},
          {"trial_capacity_at_end", f.trial ? Json(f.trial->capacity) : Json(nullptr)},
          {"trial_time_to_limit_s", f.trial ? NumberOrNull(f.trial->time_to_limit) : Json(nullptr)},
          {"endurance_at_mean_load_s", NumberOrNull(f.endurance)}};
}

Json ToJson(const HandActivity& a) {
  return {{"origin", Name(Origin::kStandard)},
          {"hand", HandName(a.hand)},
          {"exertions", a.exertions},
          {"exertions_per_s", a.frequency},
          {"duty_cycle", a.duty},
          {"peak_force_n", a.peak_force},
          {"hand_activity_level", a.level},
          {"extrapolated", !a.studied},
          {"normalized_peak_force", NumberOrNull(a.normalized_force)},
          {"normalized_peak_force_origin", a.stated ? "stated" : Name(Origin::kModelled)},
          {"ratio", NumberOrNull(a.ratio)},
          {"ratio_is_lower_bound", !a.stated}};
}

Json ToJson(const UsedTrack& track) {
  const auto& estimate = track.estimate;
  return {{"source", track.source},
          {"offset_s", track.offset},
          {"offset_uncertainty_s", estimate ? Json(estimate->uncertainty) : Json(nullptr)},
          {"offset_correlation", estimate ? Json(estimate->correlation) : Json(nullptr)}};
}

Json ToJson(const MeasuredPart& part) {
  return {{"what", part.what},
          {"origin", Name(Origin::kMeasured)},
          {"source", part.source},
          {"share_of_time", part.share},
          {"misfit_m", OptionalNumber(part.misfit)}};
}

Json ToJson(const MeasuredSignal& signal) {
  return {{"name", signal.name},
          {"unit", signal.unit},
          {"origin", Name(Origin::kMeasured)},
          {"source", signal.source},
          {"share_of_time", signal.share}};
}

// Returns one of the two activations of a channel.
Json ActivationOf(Origin origin, double mean) {
  return {{"origin", Name(origin)}, {"mean_activation", NumberOrNull(mean)}};
}

Json ToJson(const MeasuredEmg& emg) {
  const EmgAgreement agreement = AgreementOf(emg);
  return {{"muscles", PathOf(emg)},
          {"channel", emg.channel},
          {"source", emg.source},
          {"share_of_time", emg.share},
          {"largest_envelope_over_mvc", emg.largest},
          {"share_above_mvc", emg.above},
          {"weight", emg.weight},
          {"electromyogram", ActivationOf(Origin::kMeasured, agreement.measured)},
          {"model", ActivationOf(Origin::kModelled, agreement.modelled)},
          {"rms_difference", NumberOrNull(agreement.rms)}};
}

template <class T>
Json ListOf(const std::vector<T>& list) {
  Json json = Json::array();
  for (const T& entry : list) json.push_back(ToJson(entry));
  return json;
}

Json ToJson(const Comparison& comparison) {
  Json json = {{"recording", comparison.b},
               {"warning", Join(comparison.warnings, " ")},
               {"designs", comparison.designs}};
  for (const Difference& d : comparison.differences)
    json["quantities"][d.kind->path] = {{"tail", NumberOrNull(d.a)},
                                        {"tail_of_other", NumberOrNull(d.b)},
                                        {"difference_interval_90", ToJson(d.interval)},
                                        {"share_better", OptionalNumber(d.share_better)}};
  return json;
}

Json ParticipantOf(const Assessment& a) {
  if (!a.participant) return nullptr;
  const ParticipantSpec& p = *a.participant;
  return {{"pseudonym", p.pseudonym},
          {"consent_version", p.consent.version},
          {"consent_date", p.consent.date},
          {"handedness", p.handedness}};
}

Json PersonOf(const Assessment& a) {
  const BodySpec& body = a.setup.body;
  return {{"simulated", a.simulated()},
          {"operator", a.operator_type},
          {"height_m", body.height},
          {"mass_kg", body.mass},
          {"sex", body.sex == Sex::kMale ? "male" : "female"},
          {"participant", ParticipantOf(a)},
          {"reached", a.reached},
          {"reached_by_possible_postures",
           a.sampled_times.empty() ? Json(nullptr) : Json(a.sampled_reached)},
          {"largest_miss_m", a.worst_miss}};
}

// ---- schema -----------------------------------------------------------------------------------

Json QuantitySchema(const QuantityKind& kind) {
  return schema::Object(
      {{"unit", schema::Value("string", "SI unit")},
       {"origin", schema::Value("string", "measured, modelled or standard")},
       {"mean", schema::ValueOrNull("number", "over time, of the nominal posture")},
       {"p5", schema::ValueOrNull("number", "5th percentile over time")},
       {"p95", schema::ValueOrNull("number", "95th percentile over time")},
       {"min", schema::ValueOrNull("number", "smallest value")},
       {"max", schema::ValueOrNull("number", "largest value")},
       {"bad", schema::Value("string", "whether high or low values are bad")},
       {"mean_interval_90", schema::ValueOrNull("array", "90 % interval of the mean")},
       {"tail_interval_90",
        schema::ValueOrNull("array", "90 % interval of p95, or of p5 if low values are bad")}},
      WithUnit(std::string(kind.group) + ", " + kind.label, {kind.unit.si, kind.unit.si}));
}

Json WorksheetSchema(const WorksheetKind& kind) {
  const Json classes = schema::Object(
      {{"score", schema::Value("integer", "score")},
       {"share_of_time", schema::Value("number", "of the nominal posture, 0 … 1")},
       {"probability",
        schema::ValueOrNull("number", "mean over time, over the possible postures")}},
      "a score");
  return schema::Object(
      {{"origin", schema::Value("string", "standard")},
       {"worst", schema::Value("integer", "highest score")},
       {"p95", schema::Value("integer", "95th percentile over time")},
       {"action", schema::Value("string", "what the method advises for this score")},
       {"classes", schema::Array(classes, "each possible score")}},
      kind.name);
}

Json PersonSchema() {
  return schema::Object(
      {{"simulated", schema::Value("boolean", "whether the operator was simulated")},
       {"operator", schema::Value("string", "virtual, browser or person")},
       {"height_m", schema::Value("number", "height of the body [m]")},
       {"mass_kg", schema::Value("number", "mass of the body [kg]")},
       {"sex", schema::Value("string", "female or male")},
       {"participant", schema::ValueOrNull("object", "pseudonym, consent and handedness")},
       {"reached", schema::Value("number",
                                 "share of time in which the body reaches the "
                                 "handles, 0 … 1")},
       {"reached_by_possible_postures",
        schema::ValueOrNull("number", "share of time, averaged over the possible postures, 0 … 1")},
       {"largest_miss_m",
        schema::Value("number", "largest distance by which a hand misses its handle [m]")}},
      "the person");
}

Json JobSchema() {
  Json job = schema::Object(
      {{"origin", schema::Value("string", "always standard")},
       {"lifts", schema::Value("integer", "number of lifts with two hands")},
       {"duration_min", schema::Value("number", "simulated time in which the lifts occur [min]")},
       {"adapted_composite_lifting_index",
        schema::ValueOrNull("number",
                            "NIOSH's index with the weights that the hands carry; "
                            "null: outside the equation's range")},
       {"unassisted_composite_lifting_index",
        schema::ValueOrNull("number", "the same with the weights of the objects")}},
      "the lifts as one job; null: fewer than two");
  job["type"] = {"object", "null"};
  return job;
}

Json ListSchema(const char* meaning, const Json& example) {
  Json properties = Json::object();
  for (const auto& [key, value] : example.items())
    properties[key] = {{"type", value.is_object()    ? Json("object")
                                : value.is_string()  ? Json("string")
                                : value.is_boolean() ? Json("boolean")
                                                     : Json({"number", "null"})}};
  return schema::Array(schema::Object(properties, "an entry"), meaning);
}

}  // namespace

std::string AssessmentJson(const Assessment& a, const Comparison* comparison) {
  Json json = {{"recording", a.recording},
               {"scenario", a.scenario},
               {"duration_s", a.duration},
               {"held_s", a.held},
               {"person", PersonOf(a)}};
  for (const QuantityResult& q : a.quantities) json["quantities"][q.kind->path] = ToJson(q);
  for (const WorksheetResult& w : a.worksheets) json["worksheets"][w.kind->name] = ToJson(w);
  json["limits"] = ListOf(a.limits);
  json["lifts"] = ListOf(a.lifts);
  json["lifting_job"] = a.job ? ToJson(*a.job) : Json(nullptr);
  json["damage"] = ListOf(a.damage);
  json["fatigue"] = ListOf(a.fatigue);
  json["hand_activity"] = ListOf(a.hand_activity);
  json["safety"] = a.safety ? SafetyJson(*a.safety) : Json(nullptr);
  json["measured"] = {{"parts", ListOf(a.measured.parts)},
                      {"signals", ListOf(a.measured.signals)},
                      {"electromyograms", ListOf(a.measured.emg.channels)},
                      {"clocks", ListOf(a.measured.tracks)}};
  json["warnings"] = a.warnings;
  json["assumptions"] = a.assumptions;
  json["not_evaluable"] = Json::array();
  for (const NotEvaluable& n : a.not_evaluable)
    json["not_evaluable"].push_back({{"what", n.what}, {"why", n.why}});
  json["against"] = comparison ? ToJson(*comparison) : Json(nullptr);
  return json.dump(2) + "\n";
}

LiftingJob JobOf(std::span<const RecordedLifts> recordings) {
  std::vector<Lift> lifts;
  double minutes = 0;
  for (const RecordedLifts& r : recordings) {
    lifts.insert(lifts.end(), r.lifts.begin(), r.lifts.end());
    minutes += r.minutes;
  }
  return JobOf(lifts, minutes);
}

std::string LiftingJobJson(std::span<const RecordedLifts> recordings) {
  Json json = {{"recordings", Json::array()}};
  for (const RecordedLifts& r : recordings)
    json["recordings"].push_back({{"recording", r.recording},
                                  {"pseudonym", r.pseudonym},
                                  {"duration_min", r.minutes},
                                  {"lifts", ListOf(r.lifts)}});
  const LiftingJob job = JobOf(recordings);
  json["lifting_job"] = job.lifts > 1 ? ToJson(job) : Json(nullptr);
  return json.dump(2) + "\n";
}

std::string LiftingJobSchema() {
  Json recording = schema::Object(
      {{"recording", schema::Value("string", "file")},
       {"pseudonym", schema::Value("string", "of the participant; empty: not known")},
       {"duration_min", schema::Value("number", "simulated duration of the run [min]")},
       {"lifts", ListSchema("lifts and lowerings of the run", ToJson(Lift{}))}},
      "a recording");
  Json root = schema::Object(
      {{"recordings", schema::Array(std::move(recording), "the recordings of the job")},
       {"lifting_job", JobSchema()}},
      "The lifts of several recordings as the job of one person");
  root["$schema"] = schema::kDraft;
  return root.dump(2) + "\n";
}

std::string AssessmentSchema() {
  Json quantities = Json::object(), worksheets = Json::object();
  for (const QuantityKind& kind : Quantities()) quantities[kind.path] = QuantitySchema(kind);
  for (const WorksheetKind& kind : Worksheets()) worksheets[kind.name] = WorksheetSchema(kind);
  const Json text = schema::Value("string", "a sentence");
  Json root = schema::Object(
      {{"recording", schema::Value("string", "file")},
       {"scenario", schema::Value("string", "name of the scenario")},
       {"duration_s", schema::Value("number", "simulated time [s]")},
       {"held_s",
        schema::Value("number",
                      "part of it in which a hand held a handle; only this part is judged [s]")},
       {"person", PersonSchema()},
       {"quantities", schema::Object(quantities, "values over time")},
       {"worksheets", schema::Object(worksheets, "scores of observational worksheets")},
       {"limits", ListSchema("limits of the files that were given", ToJson(LimitResult{}))},
       {"lifts", ListSchema("lifts and lowerings of the run", ToJson(Lift{}))},
       {"lifting_job", JobSchema()},
       {"damage", ListSchema("cumulative damage", ToJson(DamageResult{}))},
       {"fatigue",
        ListSchema("fatigue of joints by 3CC-r, Ma's model and a stated trial, and the endurance "
                   "that was measured at the mean load",
                   ToJson(FatigueResult{}))},
       {"hand_activity",
        ListSchema("hand activity level of ACGIH, from the measured force of each hand",
                   ToJson(HandActivity{}))},
       {"safety", SafetySchema()},
       {"measured",
        schema::Object(
            {{"parts",
              ListSchema("parts of the body other than the hands", ToJson(MeasuredPart{}))},
             {"signals", ListSchema("signals that no score uses", ToJson(MeasuredSignal{}))},
             {"electromyograms",
              ListSchema("activations from electromyograms, and from the model that uses them",
                         ToJson(MeasuredEmg{}))},
             {"clocks",
              ListSchema("offsets added to the times of the files", ToJson(UsedTrack{}))}},
            "measurements in addition to the hands")},
       {"warnings", schema::Array(text, "doubtful input")},
       {"assumptions", schema::Array(text, "what was assumed")},
       {"not_evaluable", schema::Array(schema::Object({{"what", text}, {"why", text}}, "a gap"),
                                       "what could not be judged")},
       {"against",
        schema::ValueOrNull(
            "object",
            "tails of the other recording, and the differences for the same possible people")}},
      "The assessment of the person in a run of PREDICTOR");
  root["$schema"] = schema::kDraft;
  return root.dump(2) + "\n";
}

}  // namespace predictor::assessment
