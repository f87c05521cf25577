// Describes contact of the carried object in a recorded run and in the prediction of `check`, and
// writes the report's chapter about this contact.
#pragma once

#include <cmath>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "analysis/check/contact.h"
#include "core/record.h"
#include "report/page.h"
#include "scenario/scenario.h"
#include "simulation/engine.h"
#include "simulation/event_sequence.h"

namespace predictor {

// Contact of the object with one surface, computed from the recorded motions of the object and of
// the movable objects.
struct ContactFacts {
  Surface surface;
  double time = 0;   // in contact [s]
  double depth = 0;  // deepest penetration [m]
  // Largest total force of all points of contact [N], computed from the fixture's stiffness and
  // damping and from depth and speed. The force is computed only for a fixture that yields.
  double force = 0;
  double pressing = 0;  // largest force with which the hands together pressed on the surface while
                        // the object touched it, by the force sensors [N]
};

// Returns whether the object can touch anything in the scenario.
bool HasContact(const Scenario& scenario);

// Collects the ContactFacts of a run while records arrive.
class ContactCollector {
 public:
  // `scenario` contains the model files. Throws InputError.
  explicit ContactCollector(const Scenario& scenario);
  // Adds the next record.
  void Add(const TickRecord& record);
  // Returns the facts about all surfaces that the object can touch. The floor is among them.
  const std::vector<ContactFacts>& facts() const { return facts_; }

 private:
  struct Touch {
    double depth = 0, force = 0;  // deepest [m], sum [N]
    Vector3 normal = Vector3::Zero();
  };
  void Place(const TickRecord& record);
  // Returns the number of the facts about the surface, or −1 if there are none.
  int NumberOf(const Surface& surface) const;
  void AddPoint(const Contact& contact, const FrameMotion& O, std::vector<Touch>* touches) const;

  Scenario scenario_;
  EventSequence events_;
  std::unique_ptr<Engine> engine_;
  std::vector<ContactFacts> facts_;
  std::uint64_t absent_;  // fixtures: bit = number
  bool has_only_floor_;   // no other surface can touch the object
};

// The chapter's content.
struct ContactRun {
  Scenario scenario;
  std::vector<ContactFacts> facts;         // of all surfaces; empty: not known
  std::vector<ContactReport> predictions;  // empty: not known, or there are no arms
  double lead = 0;                         // for the predictions [s]
  std::string problem;                     // why something is not known, as sentences

  bool touched_floor() const;
  // Returns whether the run has anything to say about contact: the object touched the floor or can
  // touch something else, or the cobot's links can touch something.
  bool has_chapter() const;
};

// Predicts what the arms of the collected run could render with the run's lead [s]. If `lead` is
// absent, the lead that `check` chooses is used. Does nothing for a run without a chapter.
void PredictContacts(std::optional<double> lead, ContactRun* run);

// Adds the chapter.
void AddContactChapter(const ContactRun& run, ReportPage* page);

}  // namespace predictor
