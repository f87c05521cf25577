// The commands that examine scenarios and recordings.
#include "command_line.h"

namespace predictor {
namespace {

constexpr const char* kGroup = "Analyse";

void AddCheck(CLI::App* app, Request* r) {
  CLI::App* check =
      app->add_subcommand("check", "Check models, reach and stability without moving anything")
          ->group(kGroup);
  AddScenario(check, &r->scenario);
  check->add_option("--machine", r->scenario.machine, "Check on the real arms of this machine file")
      ->type_name("FILE")
      ->group("Scenario");
  check
      ->add_flag("--search,!--no-search", r->search,
                 "Search for better positions of the arms' bases [default: on]")
      ->group("Analysis");
  check
      ->add_option("--map", r->map,
                   "Also map the stable hand stiffnesses, predicted and simulated, into this "
                   "folder (minutes; continues an interrupted map)")
      ->type_name("FOLDER")
      ->group("Analysis");
  for (const auto& [name, value] :
       {std::pair{"--seed", &r->scenario.seed}, std::pair{"--duration", &r->scenario.duration}})
    check->add_option(name, *value, "Use this value instead of the scenario's")
        ->type_name("NUMBER")
        ->group("Scenario");
  AddOutput(check, &r->scenario);
  check->footer(
      "Examples:\n"
      "  predictor check scenarios/box_9kg.yaml\n"
      "  predictor check scenarios/box_9kg.yaml --map stability --json check.json\n"
      "Exit code 1: the scenario fails the check.\n");
  check->callback(
      [r] { r->command = [r] { return CheckCommand(r->scenario, r->search, r->map); }; });
}

void AddReport(CLI::App* app, Request* r) {
  CLI::App* report =
      app->add_subcommand(
             "report", "Make an HTML report about a recording, or compare up to eight recordings")
          ->group(kGroup);
  ReportOptions* o = &r->report;
  report->add_option("recordings", o->recordings, "Recordings (MCAP)")->required();
  report
      ->add_option("-o,--output", o->output,
                   "Page to write [default: NAME.html; for several recordings: comparison.html]")
      ->type_name("FILE.html")
      ->group("Output");
  AddOutput(report, o);
  report->footer("Example:\n  predictor report runs/real.mcap runs/emulated.mcap -o both.html\n");
  report->callback([r] { r->command = [r] { return ReportCommand(r->report); }; });
}

void AddCompare(CLI::App* app, Request* r) {
  CLI::App* compare =
      app->add_subcommand("compare",
                          "Compare two runs of the same task: similarity per axis, and "
                          "perceptible differences")
          ->group(kGroup);
  CompareOptions* o = &r->compare;
  compare
      ->add_option("recordings", o->a,
                   "Recording, for example of the real robot, and its repetitions")
      ->required();
  compare->add_option("--with", o->b, "Recording to compare it with, and its repetitions")
      ->required()
      ->type_name("RECORDING...")
      ->group("Comparison");
  CLI::Option* phase =
      compare->add_flag("--by-phase", o->by_phase, "Align repeated cycles with each other")
          ->group("Comparison");
  compare->add_flag("--by-time", o->by_time, "Align the runs by time since their start")
      ->excludes(phase)
      ->group("Comparison");
  AddOutput(compare, o);
  compare->footer("Example:\n  predictor compare real_*.mcap --with emulated_*.mcap\n");
  compare->callback([r] { r->command = [r] { return CompareCommand(r->compare); }; });
}

void AddVerify(CLI::App* app, Request* r) {
  CLI::App* verify =
      app->add_subcommand("verify", "Recompute a recorded run and compare it bit for bit")
          ->group(kGroup);
  verify->add_option("recording", r->recording.recording, "Recording (MCAP)")->required();
  AddOutput(verify, &r->recording);
  verify->footer(
      "Example:\n  predictor verify runs/box_9kg_2026-01-31_14-05-09.mcap\n"
      "Exit code 1: the replay differs.\n");
  verify->callback([r] { r->command = [r] { return VerifyCommand(r->recording); }; });
}

void AddIdentify(CLI::App* app, Request* r) {
  CLI::App* identify =
      app->add_subcommand("identify", "Identify the joint friction and the load of the cobot")
          ->group(kGroup);
  IdentifyCommandOptions* o = &r->identify;
  identify->add_option("recording", o->recording, "Recording (MCAP)")->required();
  identify
      ->add_option("--scenario", o->scenario,
                   "Scenario with the nominal cobot and load [default: the recording's own]")
      ->type_name("SCENARIO")
      ->group("Identification");
  identify
      ->add_option("--mass-uncertainty", o->mass_uncertainty,
                   "Standard deviation of a link's mass, relative to its mass")
      ->check(CLI::Range(0.0, 1.0))
      ->type_name("RATIO")
      ->capture_default_str()
      ->group("Identification");
  identify
      ->add_option("--com-uncertainty", o->com_uncertainty,
                   "Standard deviation of a link's centre of mass along each axis, in metres")
      ->check(CLI::Range(0.0, 1.0))
      ->type_name("METRES")
      ->capture_default_str()
      ->group("Identification");
  identify
      ->add_option("-o,--output", o->output,
                   "Write a copy of the scenario with the identified friction")
      ->type_name("SCENARIO.yaml")
      ->group("Output");
  AddOutput(identify, o);
  identify->footer(
      "Example:\n  predictor identify excite.mcap -o scenarios/identified.yaml\n"
      "Exit code 1: a joint could not be identified.\n");
  identify->callback([r] { r->command = [r] { return IdentifyCommand(r->identify); }; });
}

void AddReproduce(CLI::App* app, Request* r) {
  CLI::App* reproduce =
      app->add_subcommand("reproduce",
                          "Repeat the paper's experiments and show its figures next to ours")
          ->group(kGroup);
  ReproduceCommandOptions* o = &r->reproduce;
  reproduce->add_option("--scenarios", o->scenarios, "Folder of the project's scenarios")
      ->type_name("FOLDER")
      ->capture_default_str()
      ->group("Experiments");
  reproduce->add_option("--only", o->only, "Run this experiment only")
      ->type_name("NAME")
      ->group("Experiments");
  reproduce
      ->add_option("-o,--output", o->folder, "Folder for the page, its figures and its numbers")
      ->type_name("FOLDER")
      ->capture_default_str()
      ->group("Output");
  AddOutput(reproduce, o);
  reproduce->footer("Example:\n  predictor reproduce --only safety -o safety\n");
  reproduce->callback([r] { r->command = [r] { return ReproduceCommand(r->reproduce); }; });
}

}  // namespace

void AddAnalysisCommands(CLI::App* app, Request* r) {
  AddCheck(app, r);
  AddReport(app, r);
  AddCompare(app, r);
  AddVerify(app, r);
  AddIdentify(app, r);
  AddReproduce(app, r);
  AddSurveyCommands(app, r);
}

void AddSurveyCommands(CLI::App* app, Request* r) {
  CLI::App* survey =
      app->add_subcommand("survey",
                          "Present the questionnaire after a run, and evaluate the answers")
          ->group(kGroup)
          ->require_subcommand(1);
  SurveyOptions* o = &r->survey;
  CLI::App* ask =
      survey->add_subcommand("ask", "Let one person answer the questionnaire about a run")
          ->group("Commands");
  ask->add_option("recording", o->places, "Recording of the run, or a folder for the answer")
      ->required()
      ->expected(1);
  ask->add_option("--condition", o->condition,
                  "What the person used [default: as in the recording]")
      ->type_name("real|emulated");
  AddPort(ask, "--port", &o->port, "Port of the page (0: any)");
  ask->footer("Example:\n  predictor survey ask runs/real_1.mcap\n");
  ask->callback([r] { r->command = [r] { return SurveyAskCommand(r->survey); }; });

  CLI::App* report = survey->add_subcommand("report", "Evaluate all answers: table, tests, plot")
                         ->group("Commands");
  report->add_option("places", o->places, "Answers, or folders with answers [default: runs]");
  report->add_option("-o,--output", o->output, "Page to write")
      ->type_name("FILE.html")
      ->capture_default_str()
      ->group("Output");
  AddOutput(report, o);
  report->footer("Example:\n  predictor survey report runs -o study.html\n");
  report->callback([r] { r->command = [r] { return SurveyReportCommand(r->survey); }; });

  CLI::App* remove =
      survey->add_subcommand("remove", "Delete the answers of one person")->group("Commands");
  remove->add_option("pseudonym", o->pseudonym, "Pseudonym of the person")->required();
  remove->add_option("places", o->places, "Answers, or folders with answers [default: runs]");
  AddOutput(remove, o);
  remove->footer("Example:\n  predictor survey remove K7QM2XPX runs\n");
  remove->callback([r] { r->command = [r] { return SurveyRemoveCommand(r->survey); }; });

  survey->add_subcommand("paper", "List the answers behind the paper's Table 1")
      ->group("Commands")
      ->callback([r] { r->command = [] { return SurveyPaperCommand(); }; });
}

}  // namespace predictor
