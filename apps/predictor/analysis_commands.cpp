// The commands that examine scenarios and recordings.
#include "command_line.h"

namespace predictor {
namespace {

constexpr const char* kAnalysisGroup = "Analyse";

void AddCheck(CLI::App* app, Request* r) {
  CLI::App* check = AddCommand(app, kAnalysisGroup, "check",
                               "Check models, reach and stability without moving anything", r,
                               [r] { return CheckCommand(r->scenario, r->search, r->map); });
  AddScenario(check, &r->scenario);
  AddOption(check, "Scenario", "--machine", &r->scenario.machine, "FILE",
            "Check with the real arms of this machine file");
  check
      ->add_flag("--search,!--no-search", r->search,
                 "Search for better positions of the arms' bases [default: on]")
      ->group("Analysis");
  AddOption(check, "Analysis", "--map", &r->map.folder, "FOLDER",
            "Also map the stable stiffnesses of hands, predicted and simulated, and of walls into "
            "this folder (takes minutes; continues an interrupted map)");
  check
      ->add_flag("--only-walls", r->map.only_walls,
                 "Map only the stable stiffnesses of walls, which takes seconds")
      ->needs("--map")
      ->group("Analysis");
  for (const auto& [name, value] :
       {std::pair{"--seed", &r->scenario.seed}, std::pair{"--duration", &r->scenario.duration}})
    AddOption(check, "Scenario", name, value, "NUMBER", "Use this value instead of the scenario's");
  AddOutput(check, &r->scenario);
  check->footer(
      "Examples:\n"
      "  predictor check scenarios/box_9kg.yaml\n"
      "  predictor check scenarios/box_9kg.yaml --map stability --json check.json\n"
      "Exit code 1: the scenario fails the check.\n");
}

void AddReport(CLI::App* app, Request* r) {
  ReportOptions* o = &r->report;
  CLI::App* report =
      AddCommand(app, kAnalysisGroup, "report",
                 "Make an HTML report about a recording, or compare up to eight recordings", r,
                 [o] { return ReportCommand(*o); });
  report->add_option("recordings", o->recordings, "Recordings (MCAP)")->required();
  AddOption(report, "Output", "-o,--output", &o->output, "FILE.html",
            "Page to write [default: NAME.html; for several recordings: comparison.html]");
  AddOutput(report, o);
  AddPersonOverrides(report, &o->set);
  report->footer("Example:\n  predictor report runs/real.mcap runs/emulated.mcap -o both.html\n");
}

void AddCompare(CLI::App* app, Request* r) {
  CompareOptions* o = &r->compare;
  CLI::App* compare = AddCommand(app, kAnalysisGroup, "compare",
                                 "Compare two runs of the same task: similarity per axis, and "
                                 "perceptible differences",
                                 r, [o] { return CompareCommand(*o); });
  compare
      ->add_option("recordings", o->a,
                   "Recording, for example of the real robot, and its repetitions")
      ->required();
  AddOption(compare, "Comparison", "--with", &o->b, "RECORDING...",
            "Recording to compare it with, and its repetitions")
      ->required();
  CLI::Option* phase =
      compare->add_flag("--by-phase", o->by_phase, "Align repeated cycles with each other")
          ->group("Comparison");
  compare->add_flag("--by-time", o->by_time, "Align the runs by time since their start")
      ->excludes(phase)
      ->group("Comparison");
  AddOutput(compare, o);
  compare->footer("Example:\n  predictor compare real_*.mcap --with emulated_*.mcap\n");
}

// What the recording does not show about the work.
void AddWork(CLI::App* evaluate, EvaluateOptions* o) {
  evaluate
      ->add_flag("--repeated", o->repeated,
                 "In the real work, postures recur at least four times a minute")
      ->group("Work");
  evaluate
      ->add_flag("--held", o->held, "In the real work, postures are held for more than a minute")
      ->group("Work");
  AddOption(evaluate, "Work", "--duration", &o->lifting, "1h|2h|8h",
            "Lifts like those of the run go on for at most this time (NIOSH's three durations)")
      ->check(CLI::IsMember({"1h", "2h", "8h"}))
      ->capture_default_str();
  AddOption(evaluate, "Work", "--coupling", &o->coupling, "good|fair|poor",
            "How well the hands can grip the object, for NIOSH and REBA")
      ->check(CLI::IsMember({"good", "fair", "poor"}))
      ->capture_default_str();
  AddOption(evaluate, "Work", "--grip-effort", &o->grip_effort, "NUMBER",
            "Effort with which the hands grip, from 0 (extremely easy) to 10 (extremely hard), for "
            "DUET and the hand activity level; no sensor measures it")
      ->check(CLI::Range(0.0, 10.0));
  AddOption(evaluate, "Work", "--fatigue-trial", &o->fatigue_trial, "SHARE,SECONDS",
            "In a trial, the person held this share of the strength (0.1 to 1) until exhaustion "
            "after this time, for Peternel's model of fatigue, for example 0.5,60")
      ->delimiter(',')
      ->expected(2);
  AddRepeatable(
      evaluate, "Work", "--limits", &o->limits, "FILE.csv",
      "Limits of postures, loads, muscles or hand activity that you take from a standard, in "
      "the form of assets/limits_template.csv (repeatable)");
  AddOption(evaluate, "Work", "--contact-limits", &o->contact_limits, "FILE.csv",
            "Limits of force on the body for unintended contact, in the form of "
            "assets/contact_limits_template.csv");
}

void AddEvaluate(CLI::App* app, Request* r) {
  EvaluateOptions* o = &r->evaluate;
  CLI::App* evaluate = AddCommand(
      app, kAnalysisGroup, "evaluate",
      "Judge the person in a recording: posture, joint loads, scores, lifts, damage, fatigue", r,
      [o] { return EvaluateCommand(*o); });
  evaluate->add_option("recordings", o->recordings, "Recordings (MCAP), or imported files")
      ->required();
  AddPerson(evaluate, o);
  AddOption(evaluate, "Person", "--against", &o->against, "RECORDING",
            "Also compare with this recording of another design, for the same person");
  AddRepeatable(evaluate, "Person", "--against-track", &o->against_tracks, "FILE",
                "Like --track, for the recording that --against names (repeatable)");
  evaluate
      ->add_flag("--intervals,!--no-intervals", o->intervals,
                 "Also evaluate 64 possible postures and bodies, for intervals and probabilities "
                 "[default: on]")
      ->group("Person");
  AddOption(
      evaluate, "Person", "--arm-model", &o->arm_model, "PATH",
      "Use the arm muscles of MyoArm instead of the built-in model: the folder myo_sim/models of "
      "the package myo-sim, or one MJCF file with the whole arm");
  AddWork(evaluate, o);
  AddOption(evaluate, "Output", "-o,--output", &o->page, "FILE.html",
            "Page to write [default: NAME.person.html]. With several recordings, -o, --csv and "
            "--json name folders");
  AddOption(evaluate, "Output", "--csv", &o->csv, "FILE.csv", "Also write all values over time");
  AddOutput(evaluate, o);
  evaluate->footer(
      "Example:\n  predictor evaluate runs/box_9kg_2026-01-31_14-05-09.mcap --csv person.csv\n");
}

void AddContinue(CLI::App* app, Request* r) {
  ContinueCommandOptions* o = &r->continue_run;
  CLI::App* go_on =
      AddCommand(app, kAnalysisGroup, "continue",
                 "Predict what would have happened if the emulator had not stopped a recorded run",
                 r, [o] { return ContinueCommand(*o); });
  AddRecording(go_on, &o->recording);
  AddOption(go_on, "Operator", "--arm", &o->arm, "FILE.json",
            "Mean and covariance of the arm's impedance [default: a prior around the scenario's "
            "hand]");
  AddOption(go_on, "Operator", "--draws", &o->draws, "NUMBER", "Number of possible operators")
      ->check(CLI::Range(20, 10000))
      ->capture_default_str();
  AddOption(go_on, "Operator", "--seed", &o->seed, "NUMBER",
            "Seed of the possible operators; the same seed gives the same operators for every run")
      ->capture_default_str();
  AddOption(go_on, "Operator", "--horizon", &o->horizon, "SECONDS",
            "Time to predict after the stop")
      ->check(CLI::Range(0.1, 10.0))
      ->capture_default_str();
  AddOption(go_on, "Output", "-o,--output", &o->page, "FILE.html",
            "Page to write [default: NAME.continued.html]");
  AddOutput(go_on, o);
  go_on->footer(
      "The command can continue only those runs that used the simulated rig and stopped at a limit "
      "of force, torque, coupling or tracking.\n"
      "Example:\n  predictor continue runs/push_2026-01-31_14-05-09.mcap --json continued.json\n");
}

void AddVerify(CLI::App* app, Request* r) {
  RecordingOptions* o = &r->recording;
  CLI::App* verify = AddCommand(app, kAnalysisGroup, "verify",
                                "Recompute a recorded run and compare it bit for bit", r,
                                [o] { return VerifyCommand(*o); });
  AddRecording(verify, &o->recording);
  AddOutput(verify, o);
  verify->footer(
      "Example:\n  predictor verify runs/box_9kg_2026-01-31_14-05-09.mcap\n"
      "Exit code 1: the replay differs.\n");
}

void AddTrial(CLI::App* app, Request* r) {
  CLI::App* trial =
      AddCommand(app, kAnalysisGroup, "trial",
                 "Test a controller's library on a recorded run, as runs with real arms require", r,
                 [r] { return TrialCommand(r->scenario, r->recording.recording); });
  AddScenario(trial, &r->scenario);
  AddRecording(trial, &r->recording.recording);
  AddOutput(trial, &r->scenario);
  trial->footer(
      "Example:\n  predictor trial mine.yaml runs/mine_2026-01-31_14-05-09.mcap\n"
      "Exit code 1: the library allocates, takes too long, or returns torques that cannot be "
      "used.\n");
}

void AddIdentify(CLI::App* app, Request* r) {
  const char* group = "Identification";
  IdentifyCommandOptions* o = &r->identify;
  CLI::App* identify = AddCommand(app, kAnalysisGroup, "identify",
                                  "Identify the joint friction and the load of the cobot", r,
                                  [o] { return IdentifyCommand(*o); });
  AddRecording(identify, &o->recording);
  AddOption(identify, group, "--scenario", &o->scenario, "SCENARIO",
            "Scenario with the nominal cobot and load [default: the recording's own]");
  AddOption(identify, group, "--mass-uncertainty", &o->mass_uncertainty, "RATIO",
            "Standard deviation of a link's mass, relative to its mass")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  AddOption(identify, group, "--com-uncertainty", &o->com_uncertainty, "METRES",
            "Standard deviation of a link's centre of mass along each axis, in metres")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  AddOption(identify, "Output", "-o,--output", &o->output, "SCENARIO.yaml",
            "Write a copy of the scenario with the identified friction");
  AddOutput(identify, o);
  identify->footer(
      "Example:\n  predictor identify excite.mcap -o scenarios/identified.yaml\n"
      "Exit code 1: a joint could not be identified.\n");
}

void AddIdentifyArm(CLI::App* app, Request* r) {
  IdentifyArmOptions* o = &r->identify_arm;
  CLI::App* identify = AddCommand(app, kAnalysisGroup, "identify-arm",
                                  "Identify mass, damping, stiffness and reflex of the operator's "
                                  "arms from a run with perturbation",
                                  r, [o] { return IdentifyArmCommand(*o); });
  identify->add_option("recordings", o->recordings, "Recordings of one person (MCAP)")->required();
  AddOption(identify, "Output", "--left", &o->left, "FILE.json",
            "Write mean and covariance of the left arm");
  AddOption(identify, "Output", "--right", &o->right, "FILE.json",
            "Write mean and covariance of the right arm");
  AddOutput(identify, o);
  identify->footer(
      "Example:\n  predictor simulate scenarios/identify_arm.yaml --record arm.mcap\n"
      "  predictor identify-arm arm.mcap --left left.json\n"
      "Exit code 1: an arm could not be identified.\n");
}

void AddHazards(CLI::App* app, Request* r) {
  HazardsCommandOptions* o = &r->hazards;
  CLI::App* hazards =
      AddCommand(app, kAnalysisGroup, "hazards",
                 "Study what simulated operators feel when hazards occur, with several controllers",
                 r, [o] { return HazardsCommand(*o); });
  hazards->add_option("scenarios", o->scenarios, "Scenario files (YAML)")->required();
  AddOption(hazards, "Study", "--seeds", &o->seeds, "NUMBER",
            "Number of runs of each scenario, controller and hazard")
      ->check(CLI::Range(1, 10000))
      ->capture_default_str();
  AddOption(hazards, "Output", "-o,--output", &o->folder, "FOLDER",
            "Folder for the results; an interrupted study continues in it")
      ->capture_default_str();
  AddOutput(hazards, o);
  hazards->footer("Example:\n  predictor hazards scenarios/box_9kg.yaml --seeds 10\n");
}

void AddPopulation(CLI::App* app, Request* r) {
  PopulationCommandOptions* o = &r->population;
  CLI::App* population = AddCommand(
      app, kAnalysisGroup, "population",
      "Compare the effects of designs on the same simulated people, who have different bodies", r,
      [o] { return PopulationCommand(*o); });
  population->add_option("scenarios", o->scenarios, "Scenario files (YAML)")->required();
  AddOption(population, "Study", "--persons", &o->persons, "NUMBER", "Number of simulated people")
      ->check(CLI::Range(1, 10000))
      ->capture_default_str();
  AddRepeatable(
      population, "Study", "--heights", &o->heights, "M,M,...",
      "Heights of the handles above the ground; each height is a design [default: the scenario's]")
      ->delimiter(',')
      ->check(CLI::Range(0.1, 2.5));
  AddRepeatable(population, "Study", "--set", &o->set, "KEY=VALUE",
                "Change a value of all scenarios (repeatable)");
  AddOption(population, "Study", "--population-seed", &o->seed, "NUMBER",
            "Seed of the simulated people; the same number gives the same people")
      ->capture_default_str();
  AddOption(population, "Study", "--jobs", &o->workers, "NUMBER",
            "Number of simultaneous runs [default: the number of cores]")
      ->check(CLI::Range(1, 1024));
  AddOption(population, "Output", "-o,--output", &o->folder, "FOLDER",
            "Folder for the results; an interrupted study continues in it")
      ->capture_default_str();
  AddOutput(population, o);
  population->footer(
      "Example:\n  predictor population scenarios/box_9kg.yaml scenarios/box_18kg.yaml "
      "--heights 0.8,1.0,1.2 --persons 50\n");
}

void AddReproduce(CLI::App* app, Request* r) {
  ReproduceCommandOptions* o = &r->reproduce;
  CLI::App* reproduce =
      AddCommand(app, kAnalysisGroup, "reproduce",
                 "Repeat the paper's experiments and show its figures next to ours", r,
                 [o] { return ReproduceCommand(*o); });
  AddOption(reproduce, "Experiments", "--scenarios", &o->scenarios, "FOLDER",
            "Folder of the project's scenarios")
      ->capture_default_str();
  AddOption(reproduce, "Experiments", "--only", &o->only, "NAME", "Run this experiment only");
  AddRepeatable(reproduce, "Experiments", "--set", &o->set, "KEY=VALUE",
                "Change a value of all scenarios, for example simulation.engine=dart (repeatable)");
  AddOption(reproduce, "Output", "-o,--output", &o->folder, "FOLDER",
            "Folder for the page, its figures and its numbers")
      ->capture_default_str();
  AddOutput(reproduce, o);
  reproduce->footer("Example:\n  predictor reproduce --only safety -o safety\n");
}

void AddSurvey(CLI::App* app, Request* r) {
  CLI::App* survey =
      app->add_subcommand("survey",
                          "Present the questionnaire after a run, and evaluate the answers")
          ->group(kAnalysisGroup)
          ->require_subcommand(1);
  SurveyOptions* o = &r->survey;

  CLI::App* ask =
      AddCommand(survey, "Commands", "ask", "Let one person answer the questionnaire about a run",
                 r, [o] { return SurveyAskCommand(*o); });
  ask->add_option("recording", o->places, "Recording of the run, or a folder for the answer")
      ->required()
      ->expected(1);
  ask->add_option("--condition", o->condition,
                  "What the person used [default: as in the recording]")
      ->type_name("real|emulated");
  AddPort(ask, "Options", "--port", &o->port, "Port of the page (0: any)");
  AddJson(ask, o);
  AddForce(ask, o);
  ask->footer("Example:\n  predictor survey ask runs/real_1.mcap\n");

  CLI::App* report =
      AddCommand(survey, "Commands", "report", "Evaluate all answers: table, tests, plot", r,
                 [o] { return SurveyReportCommand(*o); });
  report->add_option("places", o->places, "Answers, or folders with answers [default: runs]");
  AddOption(report, "Output", "-o,--output", &o->output, "FILE.html", "Page to write")
      ->capture_default_str();
  AddOutput(report, o);
  report->footer("Example:\n  predictor survey report runs -o study.html\n");

  CLI::App* remove = AddCommand(survey, "Commands", "remove", "Delete the answers of one person", r,
                                [o] { return SurveyRemoveCommand(*o); });
  remove->add_option("pseudonym", o->pseudonym, "Pseudonym of the person")->required();
  remove->add_option("places", o->places, "Answers, or folders with answers [default: runs]");
  AddOutput(remove, o);
  remove->footer("Example:\n  predictor survey remove K7QM2XPX runs\n");

  AddCommand(survey, "Commands", "paper", "List the answers behind the paper's Table 1", r,
             SurveyPaperCommand);
}

}  // namespace

void AddAnalysisCommands(CLI::App* app, Request* r) {
  AddCheck(app, r);
  AddReport(app, r);
  AddCompare(app, r);
  AddEvaluate(app, r);
  AddContinue(app, r);
  AddVerify(app, r);
  AddTrial(app, r);
  AddIdentify(app, r);
  AddIdentifyArm(app, r);
  AddHazards(app, r);
  AddPopulation(app, r);
  AddReproduce(app, r);
  AddSurvey(app, r);
}

}  // namespace predictor
