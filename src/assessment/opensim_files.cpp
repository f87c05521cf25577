#include "assessment/opensim_files.h"

#include <utility>

#include "assessment/person_chain.h"
#include "core/error.h"
#include "core/format.h"

namespace predictor::assessment {
namespace {

using person::InOpenSim;
using person::kBodyJoints;

// Returns the first sample and the number of samples of the longest part without interruption.
std::pair<std::size_t, std::size_t> LongestPart(std::span<const PersonSample> samples) {
  std::pair<std::size_t, std::size_t> longest = {0, 0};
  for (std::size_t begin = 0, end = 0; begin < samples.size(); begin = end) {
    end = begin + 1;
    while (end < samples.size() && samples[end].continues) ++end;
    if (end - begin > longest.second) longest = {begin, end - begin};
  }
  return longest;
}

// A table in the format of OpenSim's storage files.
class Storage {
 public:
  Storage(const std::string& name, const std::vector<std::string>& columns, std::size_t rows) {
    Append(&text_, "%s\nversion=1\nnRows=%zu\nnColumns=%zu\ninDegrees=no\nendheader\ntime",
           name.c_str(), rows, columns.size() + 1);
    for (const std::string& column : columns) Append(&text_, "\t%s", column.c_str());
    text_ += '\n';
  }
  void Begin(double time) { Append(&text_, "%.6f", time); }
  void Add(double x) { Append(&text_, "\t%.12g", x); }
  void Add(const Vector3& v) {
    for (const double x : v) Add(x);
  }
  void End() { text_ += '\n'; }
  const std::string& text() const { return text_; }

 private:
  std::string text_;
};

std::vector<std::string> LoadColumns() {
  std::vector<std::string> columns;
  for (const char* hand : kHandNames)
    for (const char* what : {"_force_v", "_force_p", "_torque_"})
      for (const char* axis : {"x", "y", "z"}) columns.push_back(std::string(hand) + what + axis);
  return columns;
}

std::string LoadsXml() {
  std::string forces;
  for (const std::string hand : kHandNames)
    for (const auto& [before, after] :
         {std::pair("<ExternalForce name=\"", "_handle\">\n"),
          std::pair("<applied_to_body>", "_hand</applied_to_body>\n"),
          std::pair("<force_expressed_in_body>ground</force_expressed_in_body>\n"
                    "<point_expressed_in_body>ground</point_expressed_in_body>\n"
                    "<force_identifier>",
                    "_force_v</force_identifier>\n"),
          std::pair("<point_identifier>", "_force_p</point_identifier>\n"),
          std::pair("<torque_identifier>", "_torque_</torque_identifier>\n</ExternalForce>\n")})
      forces.append(before).append(hand).append(after);
  return "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<OpenSimDocument Version=\"40500\">\n"
         "<ExternalLoads name=\"hand_loads\">\n<objects>\n" +
         forces +
         "</objects>\n<datafile>hand_loads.sto</datafile>\n</ExternalLoads>\n"
         "</OpenSimDocument>\n";
}

std::string ToolXml(double begin, double end) {
  return Formatted(
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<OpenSimDocument Version=\"40500\">\n"
      "<InverseDynamicsTool name=\"person\">\n<results_directory>.</results_directory>\n"
      "<model_file>person.osim</model_file>\n<time_range>%.6f %.6f</time_range>\n"
      "<forces_to_exclude>Muscles</forces_to_exclude>\n"
      "<external_loads_file>hand_loads.xml</external_loads_file>\n"
      "<coordinates_file>motion.mot</coordinates_file>\n"
      "<lowpass_cutoff_frequency_for_coordinates>-1</lowpass_cutoff_frequency_for_coordinates>\n"
      "<output_gen_force_file>opensim_torques.sto</output_gen_force_file>\n"
      "</InverseDynamicsTool>\n</OpenSimDocument>\n",
      begin, end);
}

}  // namespace

std::vector<NamedFile> OpenSimFiles(const PersonSetup& setup,
                                    std::span<const PersonSample> samples) {
  const auto [begin, count] = LongestPart(samples);
  constexpr std::size_t kMinSamples = 10;
  if (count < kMinSamples)
    throw InputError(
        "No hand holds a handle for 0.1 s without interruption, so there is no motion "
        "to export.");
  const auto part = samples.subspan(begin, count);
  NominalPerson nominal(setup, {});
  std::vector<person::BodyVector> postures;
  for (const PersonSample& sample : part) postures.push_back(nominal.Solve(sample).q);
  const auto motions = person::SmoothMotion(postures, 1 / kSampleRate);
  const person::BodyModel& model = nominal.model();
  std::vector<std::string> joints, moments;
  for (int i = 0; i < kBodyJoints; ++i) {
    joints.emplace_back(person::JointName(i));
    moments.push_back(joints.back() + (person::IsPrismatic(i) ? "_force" : "_moment"));
  }
  Storage coordinates("Coordinates", joints, count), torques("Inverse Dynamics", moments, count),
      loads("hand_loads", LoadColumns(), count);
  for (std::size_t k = 0; k < count; ++k) {
    const person::BodyMotion& motion = motions[k];
    const auto wrenches = person::WrenchesOn(part[k].body, setup.stance);
    const person::JointLoads result =
        person::InverseDynamics(model, motion.q, motion.v, motion.a, wrenches);
    for (Storage* table : {&coordinates, &torques, &loads}) table->Begin(part[k].recorded);
    for (int i = 0; i < kBodyJoints; ++i) {
      coordinates.Add(motion.q[i]);
      torques.Add(result.torque[i]);
    }
    for (const person::ExternalWrench& wrench : wrenches) {
      loads.Add(InOpenSim(wrench.F.head<3>()));
      loads.Add(InOpenSim(wrench.p));
      loads.Add(InOpenSim(wrench.F.tail<3>()));
    }
    for (Storage* table : {&coordinates, &torques, &loads}) table->End();
  }
  return {{"person.osim", person::OpenSimModelOf(model)},
          {"motion.mot", coordinates.text()},
          {"hand_loads.sto", loads.text()},
          {"hand_loads.xml", LoadsXml()},
          {"inverse_dynamics.xml", ToolXml(part.front().recorded, part.back().recorded)},
          {"torques.sto", torques.text()}};
}

}  // namespace predictor::assessment
