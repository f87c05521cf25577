#include "command_line.h"

namespace predictor {
namespace {

// Returns the reason why a text is not an origin in the form that browsers send, which consists of
// a scheme, a host and optionally a port.
std::string NoOrigin(const std::string& text) {
  const std::size_t scheme = text.find("://");
  const bool web = text.starts_with("http://") || text.starts_with("https://");
  if (web && scheme + 3 < text.size() &&
      text.find_first_of("/?#@ ", scheme + 3) == std::string::npos)
    return "";
  return "'" + text +
         "' is not an origin: give scheme and host, for example https://app.foxglove.dev";
}

}  // namespace

CLI::App* AddCommand(CLI::App* app, const char* group, const char* name, const char* what,
                     Request* r, std::function<int()> run) {
  CLI::App* command = app->add_subcommand(name, what)->group(group);
  command->callback([r, run = std::move(run)] { r->command = run; });
  return command;
}

CLI::Option* AddPort(CLI::App* app, const char* group, const char* name, std::uint16_t* port,
                     const char* what) {
  return AddOption(app, group, name, port, "PORT", what)
      ->check(CLI::Range(0, 65535))
      ->capture_default_str();
}

void AddPersonOverrides(CLI::App* app, std::vector<std::string>* set) {
  AddRepeatable(app, "Person", "--set", set, "KEY=VALUE",
                "Override a value of the recorded scenario, for example operator.body.height=1.62 "
                "(repeatable)");
}

void AddPerson(CLI::App* app, PersonOptions* o) {
  AddPersonOverrides(app, &o->set);
  AddRepeatable(
      app, "Person", "--track", &o->tracks, "FILE",
      "Measured head, elbows or signals: a table (CSV), or a mapping (YAML) of a CSV, TRC or "
      "C3D file (repeatable)");
}

void AddRecording(CLI::App* app, std::string* recording) {
  app->add_option("recording", *recording, "Recording (MCAP)")->required();
}

void AddScenario(CLI::App* app, ScenarioOptions* o) {
  app->add_option("scenario", o->file, "Scenario file (YAML)")->required();
  AddRepeatable(app, "Scenario", "--set", &o->set, "KEY=VALUE",
                "Override a value of the scenario, for example operator.script.1.duration=2 "
                "(repeatable)");
}

void AddQuiet(CLI::App* app, OutputOptions* o) {
  app->add_flag("-q,--quiet", o->quiet, "Print errors and warnings only")->group("Output");
}

void AddForce(CLI::App* app, OutputOptions* o) {
  app->add_flag("--force", o->force, "Replace existing files")->group("Output");
}

void AddJson(CLI::App* app, OutputOptions* o) {
  AddOption(app, "Output", "--json", &o->json, "FILE",
            "Write the result as JSON to this file, or to standard output without FILE or with - "
            "(the text then goes to standard error)")
      ->expected(0, 1)
      ->default_str("-");
}

void AddOutput(CLI::App* app, OutputOptions* o) {
  AddJson(app, o);
  AddForce(app, o);
  AddQuiet(app, o);
}

void AddPageOptions(CLI::App* app, ServeOptions* o) {
  const char* group = "Viewer";
  AddPort(app, group, "--port", &o->page.port, "Port of the viewer (0: any)");
  AddOption(app, group, "--address", &o->page.address, "ADDRESS",
            "Address to serve on: 127.0.0.1, or 0.0.0.0 with --expose");
  CLI::Option* expose =
      app->add_flag("--expose", o->page.expose,
                    "Let other computers connect to the viewer, over TLS and with a code")
          ->group(group);
  CLI::Option* certificate = AddOption(app, group, "--certificate", &o->page.certificate, "FILE",
                                       "Your own certificate (PEM)")
                                 ->needs(expose);
  certificate->needs(
      AddOption(app, group, "--key", &o->page.key, "FILE", "Private key of the certificate (PEM)")
          ->needs(certificate));
  AddRepeatable(app, group, "--name", &o->page.names, "HOST",
                "Additional host name of this machine (repeatable)");
  AddRepeatable(app, group, "--foxglove-origin", &o->page.foxglove_origins, "ORIGIN",
                "Page that may connect as Foxglove, for example https://app.foxglove.dev")
      ->check(CLI::Validator(NoOrigin, ""));
}

}  // namespace predictor
