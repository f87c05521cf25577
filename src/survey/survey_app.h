// Provides the questionnaire as a page. A person who has the code consents, answers, and receives a
// pseudonym. The application uses the viewer's server and follows its rules. The texts are
// described in docs/how-to/questionnaire.md.
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

namespace predictor::survey {

inline constexpr const char* kSurveySubprotocol = "predictor.survey.v1";
// Returns "index.html", "survey.css" or "survey.js", which are compiled in, or nothing for any
// other name.
std::string_view SurveyPageFile(std::string_view name);

struct SurveySetup {
  std::vector<std::string> hosts;  // host names of this server, without port
  // The condition that the person used before answering. If the condition is empty, the person
  // enters it on the page.
  std::optional<Condition> condition;
  // Stores an answer, which already has a pseudonym. May throw InputError, which is shown to the
  // person.
  std::function<void(const SurveyAnswer&)> store;
  std::function<std::uint64_t()> clock;  // monotonic [ns]
};

enum class SurveyEnd { kNone, kStored, kDeclined };

// Handles one answer, or the person's decision not to answer. This function runs in the server's
// single thread.
class SurveyApp : public viewer::Application {
 public:
  static constexpr std::uint64_t kHelloTime = 5'000'000'000;  // [ns]
  static constexpr int kMaxMessages = 100;                    // limit for one connection

  explicit SurveyApp(SurveySetup setup);
  ~SurveyApp() override;

  viewer::HttpReply Get(const viewer::HttpRequest& request) override;
  viewer::UpgradeReply Upgrade(const viewer::HttpRequest& request) override;
  void Tick() override;

  // Returns the code that admits one browser, which then uses a token to reconnect.
  const std::string& code() const { return admission_.code(); }
  // Returns the reason why the survey ended.
  SurveyEnd end() const { return end_; }
  // `over` is called once, after the page has shown the end or the page's connection has been
  // closed.
  void OnOver(std::function<void()> over) { over_ = std::move(over); }

 private:
  class Client;

  SurveySetup setup_;
  viewer::Admission admission_;
  std::vector<Client*> clients_;
  SurveyEnd end_ = SurveyEnd::kNone;
  std::function<void()> over_;
};

}  // namespace predictor::survey
