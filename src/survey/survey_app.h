// The questionnaire as a page: who was given the code agrees, answers, and gets a pseudonym. Over
// the viewer's server, by its rules; docs/questionnaire.md tells what is said.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "evaluation/questionnaire.h"
#include "viewer/admission.h"
#include "viewer/connection.h"

namespace predictor {

inline constexpr const char* kSurveySubprotocol = "predictor.survey.v1";
// "index.html", "survey.css" or "survey.js", compiled in; empty for another name.
std::string_view SurveyPageFile(std::string_view name);

struct SurveySetup {
  std::vector<std::string> hosts;      // names by which this server may be called, without port
  std::optional<Condition> condition;  // what was used before; nothing: the person is asked
  // Keeps an answer, which has a pseudonym by then. May throw InputError, which the person is told.
  std::function<void(const SurveyAnswer&)> store;
  std::function<std::uint64_t()> clock;  // monotonic [ns]
};

enum class SurveyEnd { kNone, kStored, kDeclined };

// One answer, or the word that there will be none. In the server's one thread.
class SurveyApp : public Application {
 public:
  static constexpr std::uint64_t kHelloTime = 5'000'000'000;  // [ns]
  static constexpr int kMostMessages = 100;                   // of one connection

  explicit SurveyApp(SurveySetup setup);
  ~SurveyApp() override;

  HttpReply Get(const HttpRequest& request) override;
  UpgradeReply Upgrade(const HttpRequest& request) override;
  void Tick() override;

  // Admits one browser (which then comes back by a token).
  const std::string& code() const { return admission_.code(); }
  // What came of it.
  SurveyEnd end() const { return end_; }
  // Called once, when the person has been told the end or their connection is gone.
  void OnOver(std::function<void()> over) { over_ = std::move(over); }

 private:
  class Client;

  SurveySetup setup_;
  Admission admission_;
  std::vector<Client*> clients_;
  SurveyEnd end_ = SurveyEnd::kNone;
  std::function<void()> over_;
};

}  // namespace predictor
