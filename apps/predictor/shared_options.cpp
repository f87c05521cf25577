#include "command_line.h"

namespace predictor {
namespace {

// An origin as browsers send it: scheme and host, optionally a port, and nothing after them.
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

CLI::Option* AddPort(CLI::App* app, const char* name, std::uint16_t* port, const char* what) {
  return app->add_option(name, *port, what)
      ->check(CLI::Range(0, 65535))
      ->type_name("PORT")
      ->capture_default_str();
}

void AddScenario(CLI::App* app, ScenarioOptions* o) {
  app->add_option("scenario", o->file, "Scenario file (YAML)")->required();
  app->add_option("--set", o->set,
                  "Override a value of the scenario, for example operator.script.1.duration=2 "
                  "(repeatable)")
      ->type_name("KEY=VALUE")
      ->take_all()
      ->expected(1)
      ->allow_extra_args(false)
      ->group("Scenario");
}

void AddQuiet(CLI::App* app, OutputOptions* o) {
  app->add_flag("-q,--quiet", o->quiet, "Print errors and warnings only")->group("Output");
}

void AddForce(CLI::App* app, OutputOptions* o) {
  app->add_flag("--force", o->force, "Replace existing files")->group("Output");
}

void AddJson(CLI::App* app, OutputOptions* o) {
  app->add_option("--json", o->json,
                  "Write the result as JSON to this file, or to standard output without FILE or "
                  "with - (the text then goes to standard error)")
      ->type_name("FILE")
      ->expected(0, 1)
      ->default_str("-")
      ->group("Output");
}

void AddOutput(CLI::App* app, OutputOptions* o) {
  AddJson(app, o);
  AddForce(app, o);
  AddQuiet(app, o);
}

void AddPageOptions(CLI::App* app, ServeOptions* o) {
  const char* group = "Viewer";
  AddPort(app, "--port", &o->page.port, "Port of the viewer (0: any)")->group(group);
  app->add_option("--address", o->page.address,
                  "Address to serve on: 127.0.0.1, or 0.0.0.0 with --expose")
      ->type_name("ADDRESS")
      ->group(group);
  CLI::Option* expose = app->add_flag("--expose", o->page.expose,
                                      "Let other machines reach the viewer, by TLS and a code")
                            ->group(group);
  CLI::Option* certificate =
      app->add_option("--certificate", o->page.certificate, "Your own certificate (PEM)")
          ->type_name("FILE")
          ->needs(expose)
          ->group(group);
  certificate->needs(app->add_option("--key", o->page.key, "Private key of the certificate (PEM)")
                         ->type_name("FILE")
                         ->needs(certificate)
                         ->group(group));
  app->add_option("--name", o->page.names, "Additional host name of this machine (repeatable)")
      ->type_name("HOST")
      ->group(group);
  app->add_option("--foxglove-origin", o->page.foxglove_origins,
                  "Page that may connect as Foxglove, for example https://app.foxglove.dev")
      ->check(CLI::Validator(NoOrigin, ""))
      ->type_name("ORIGIN")
      ->group(group);
}

}  // namespace predictor
