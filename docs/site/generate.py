#!/usr/bin/env python3
"""Writes the reference pages of the site from the program and its sources: generate.py PROGRAM.

The pages go to docs/reference/generated/, which is not in the repository. If a page lacks an
input, this is an error, so that no page is silently incomplete.
"""
import json
import pathlib
import re
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
PAGES = ROOT / "docs" / "reference" / "generated"
HEADERS = ["emulator/emulator.h", "scenario/scenario.h", "core/record.h", "core/run_input.h", "core/status.h",
           "core/messages.h", "core/types.h", "devices/device.h", "simulation/controller.h"]


def run(*arguments, codes=(0,)):
    done = subprocess.run([str(a) for a in arguments], cwd=ROOT, capture_output=True, text=True, check=False)
    if done.returncode not in codes:
        sys.exit(f"{' '.join(map(str, arguments))} ended with {done.returncode}:\n{done.stdout}{done.stderr}")
    return done.stdout


def table(head, rows):
    cells = [[str(cell).replace("|", "\\|").replace("\n", " ") for cell in row] for row in [head, *rows]]
    lines = ["| " + " | ".join(row) + " |" for row in cells]
    return "\n".join([lines[0], "|" + "---|" * len(head), *lines[1:]])


# ---- keys of a file, from its JSON Schema --------------------------------------------------------------------------

def alternatives(schema):
    return [a for a in schema.get("anyOf", schema.get("oneOf", [schema])) if a.get("type") != "null"]


def number(value):
    return f"{value:g}"


def allowed(schema):
    """Describes the values that a key may have."""
    if "anyOf" in schema or "oneOf" in schema:
        return ", or ".join(dict.fromkeys(allowed(a) for a in schema.get("anyOf", schema.get("oneOf"))))
    if "enum" in schema:
        return ", ".join(f"`{value}`" if isinstance(value, str) else str(value) for value in schema["enum"])
    if "const" in schema:
        return f"`{schema['const']}`"
    if "pattern" in schema:
        return "`N deg`"  # the only pattern: an angle in degrees
    kind = schema.get("type")
    if kind == "array":
        least, most = schema.get("minItems", 0), schema.get("maxItems")
        count = str(least) if least == most else f"{least} to {most}"
        return f"{count} × {allowed(schema['items'])}"
    if kind in ("number", "integer"):
        low = f"> {number(schema['exclusiveMinimum'])}" if "exclusiveMinimum" in schema else \
            f"≥ {number(schema['minimum'])}" if "minimum" in schema else ""
        high = f"≤ {number(schema['maximum'])}" if "maximum" in schema else ""
        return ", ".join(part for part in (low, high) if part) or kind
    return {"boolean": "true, false", "string": "text", "object": "group of keys", "null": "null"}.get(kind, str(kind))


def default(schema, required):
    if "default" in schema:
        return f"`{json.dumps(schema['default'], ensure_ascii=False)}`"
    return "**required**" if required else ""


UNIT = re.compile(r"\s*\[([^\[\],]*)\]")


def describe(schema):
    """Returns unit and meaning. The schema writes the unit in brackets."""
    text = schema.get("description", "")
    found = UNIT.search(text)
    unit = schema.get("unit", found[1] if found else "")
    return unit, (text if "unit" in schema or not found else text[:found.start()] + text[found.end():]).strip()


def keys(schema, path=""):
    """Returns the sections (path, meaning, rows) of all groups, depth first."""
    rows, below = [], []
    required = schema.get("required", [])
    for key, value in schema.get("properties", {}).items():
        name = f"{path}.{key}" if path else key
        unit, meaning = describe(value)
        rows.append((f"`{key}`", default(value, key in required), unit, allowed(value), meaning))
        for one in alternatives(value):
            if "properties" in one:
                (_, about, own), *inner = keys(one, name)
                below += [(f"{name}, type {one['title']}" if "title" in one else name, about, own), *inner]
            elif one.get("type") == "array":
                for item in alternatives(one["items"]):
                    if "properties" in item:
                        (_, about, own), *inner = keys(item, f"{name}[]")
                        below += [(f"{name}[], {item['title']}" if "title" in item else f"{name}[]", about, own), *inner]
    return [(path, schema.get("description", ""), rows)] + below


def with_requirements(schema, needs=None):
    """Moves required keys that apply only to files without `extends` back to their places."""
    if needs is None:
        needs = next((a for a in schema.get("anyOf", []) if "extends" not in a.get("required", ["extends"])), {})
        schema = {key: value for key, value in schema.items() if key != "anyOf"}
    joined = schema | {key: value for key, value in needs.items() if key == "required"}
    for key, inner in needs.get("properties", {}).items():
        joined["properties"] = joined["properties"] | {key: with_requirements(joined["properties"][key], inner)}
    if "anyOf" in needs:
        joined["anyOf"] = [with_requirements(one, inner) for one, inner in zip(joined["anyOf"], needs["anyOf"])]
    return joined


def keys_page(title, introduction, schema):
    parts, seen = [f"# {title}", introduction], set()
    for path, meaning, rows in keys(schema):
        text = table(("key", "default", "unit", "allowed", "meaning"), rows)
        if not rows or (path, text) in seen:
            continue
        seen.add((path, text))
        parts += [f"## {path or 'Top level'}", meaning, text]
    return "\n\n".join(part for part in parts if part)


def json_schema(program, of):
    return json.loads(run(program, "schema", of))


def reference(program, of):
    return json.loads(run(program, "reference", of))


# ---- the command line ----------------------------------------------------------------------------------------------

def subcommands(program, path):
    """Returns the names in the help that are commands, because they support --help themselves."""
    found = []
    for name in re.findall(r"^  ([a-z][a-z-]*)(?: [A-Z<\[].*?)?(?:  +|$)", run(program, *path, "--help"), re.M):
        done = subprocess.run([program, *path, name, "--help"], capture_output=True, text=True, check=False)
        if done.returncode == 0 and name not in found and name != "help":
            found.append(name)
    return found


def command_line_page(program):
    parts = ["# Command line", "The text that `predictor COMMAND --help` prints."]

    def add(path):
        title = " ".join(["predictor", *path])
        parts.append(f"{'#' * min(4, 2 + len(path) // 2)} {title}\n\n```text\n{run(program, *path, '--help').rstrip()}\n```")
        if len(path) < 2:
            for name in subcommands(program, path) if not path or " COMMAND [" in parts[-1] else []:
                add([*path, name])
    add([])
    if len(parts) < 10:
        sys.exit("the help of the program names too few commands: generate.py does not understand it")
    return "\n\n".join(parts)


# ---- what a run leaves ---------------------------------------------------------------------------------------------

INDEX = re.compile(r"\[(\d+)\]")


def quantities_page(quantities):
    """Lists every number of a recording. The numbers of an array share a row."""
    groups, arrays = {}, {}
    for one in quantities:
        name = one["name"]
        if not one["meaning"]:
            sys.exit(f"src/core/tick_fields.h gives {name} no meaning")
        row = arrays.setdefault((INDEX.sub("[]", name), *list(one.values())[1:]), [])
        row.append([int(index) for index in INDEX.findall(name)])
    for (name, *rest), indices in arrays.items():
        for least, most in zip(*(map(f, zip(*indices)) for f in (min, max))):
            name = name.replace("[]", f"[{least}…{most}]" if most > least else f"[{least}]", 1)
        groups.setdefault(re.match(r"hands\.\w+|\w+", name)[0], []).append((f"`{name}`", *rest))
    if len(groups) < 9:
        sys.exit("`predictor reference quantities` lists too few groups")
    parts = ["# Recorded quantities",
             "The numbers of each tick, by the names that `predictor export data` gives them. "
             "A recording contains the numbers of those arms, joints and objects that exist. "
             "The type is that of ROS 2 messages, and flags and enumerations are integers. "
             "The components refer to the axes of this frame. In this table, S is the frame of the sensor. "
             "[Recordings](../recording.md) describes the file format. The schemas in a recording name the values of enumerations."]
    for group, rows in groups.items():
        parts += [f"## {group}", table(("name", "type", "unit", "frame", "meaning"), rows)]
    return "\n\n".join(parts)


def result_rows(part, path=""):
    for key, value in part["properties"].items():
        name = f"{path}.{key}" if path else key
        if "properties" in value:
            yield from result_rows(value, name)
            continue
        kind = value.get("$ref", "").rpartition("/")[2] or value["type"]
        if isinstance(kind, list):
            kind = " or ".join(kind)
        yield (f"`{name}`", value.get("unit", ""), kind, value["description"])


def described_rows(part, path=""):
    """Lists every member that has a description, and those within it."""
    for key, value in part["properties"].items():
        name = f"{path}.{key}" if path else key
        if "description" in value:
            unit, meaning = describe(value)
            kind = value.get("type", "object")
            yield (f"`{name}`", unit, " or ".join(kind) if isinstance(kind, list) else kind, meaning)
        if "properties" in value:
            yield from described_rows(value, name)


def summary_page(schema):
    head = ("key", "unit", "value", "meaning")
    defined = schema["$defs"]
    return "\n\n".join([
        "# Summary JSON", "What `--json` writes about a run, from `predictor schema summary`. "
        "A missing value is null, and so is a group in which every value is missing.",
        table(head, result_rows(schema)),
        "A value *statistics* is a group: " + defined["statistics"]["description"] + " (`mean`, `std`, `max`). "
        "*Quantiles* are the median, 99 %, 99.9 % and the largest value (`p50`, `p99`, `p999`, `max`).",
        "## A stop", "`stop` is the first stop, and `stops` lists all of them.", table(head, result_rows(defined["stop"]))])


def evaluation_page(schema, job):
    properties = schema["properties"]
    quantities = [(f"`{name}`", value["description"]) for name, value in properties["quantities"]["properties"].items()]
    one = next(iter(properties["quantities"]["properties"].values()))
    sheet = next(iter(properties["worksheets"]["properties"].values()))
    rest = {key: value for key, value in properties.items() if key not in ("quantities", "worksheets")}
    head = ("key", "unit", "value", "meaning")
    return "\n\n".join([
        "# Evaluation JSON", "What `predictor evaluate --json` writes about the person, from `predictor schema evaluation`. "
        "[Evaluate the person](../../how-to/evaluate-the-person.md) explains it.",
        table(head, result_rows({"properties": rest})),
        "## quantities", table(("key", "quantity and SI unit"), quantities),
        "Each of them has these members:", table(head, result_rows(one)),
        "## worksheets", "`RULA`, `REBA` and `OWAS` have these members each:", table(head, result_rows(sheet)),
        "## lifting_job.json", "What the command writes in addition for several recordings, from `predictor schema lifting-job`.",
        table(head, result_rows(job))])


def check_page(schema):
    head = ("key", "unit", "value", "meaning")
    properties = schema["properties"]
    reach, stability = properties["reach"], properties["stability"]
    contact = properties["contacts"]["items"]
    simple = {key: value for key, value in properties.items() if key not in ("models", "reach", "proposal", "stability")}
    return "\n\n".join([
        "# Check JSON", "What `predictor check --json` writes, from `predictor schema check`. "
        "[Check a scenario](../../how-to/check.md) explains it.",
        table(head, described_rows({"properties": simple})),
        "## reach", "`proposal` repeats these figures for better positions.", table(head, described_rows(reach)),
        "## stability", table(head, described_rows(stability)),
        "## contacts", "[Contact](../../how-to/fixtures.md#what-the-arms-can-render) explains these predictions.",
        table(head, described_rows(contact))])


def continuation_page(schema):
    properties = schema["properties"]
    predicted = properties["predicted"]["properties"]
    quantities = [(f"`{name}`", value["description"]) for name, value in predicted.items()]
    one = next(iter(predicted.values()))
    draw = properties["draws"]["items"]
    rest = {key: value for key, value in properties.items() if key not in ("predicted", "draws")}
    head = ("key", "unit", "value", "meaning")
    return "\n\n".join([
        "# Continuation JSON", "What `predictor continue --json` writes about a stopped run, from `predictor schema continuation`. "
        "[Continue a run that the emulator stopped](../../how-to/continue-a-stopped-run.md) explains it.",
        table(head, result_rows({"properties": rest})),
        "## predicted", table(("key", "quantity and SI unit"), quantities),
        "Each of them has these members:", table(head, result_rows(one)),
        "## draws", "Each possible operator has these members:", table(head, result_rows(draw))])


def population_page(schema):
    design = schema["properties"]["designs"]["items"]
    quantities = design["properties"]["quantities"]["properties"]
    names = [(f"`{name}`", value["description"]) for name, value in quantities.items()]
    one = next(iter(quantities.values()))
    rest = {key: value for key, value in design["properties"].items() if key != "quantities"}
    head = ("key", "unit", "value", "meaning")
    return "\n\n".join([
        "# Population JSON", "What `predictor population --json` writes, from `predictor schema population`. "
        "[Compare designs for a population](../../how-to/population.md) explains it.",
        table(head, result_rows({"properties": {**schema["properties"]}})),
        "## people", table(head, result_rows(schema["properties"]["people"]["items"])),
        "## designs", table(head, result_rows({"properties": rest})),
        "## quantities of a design", table(("key", "quantity and SI unit"), names),
        "Each of them has these members:", table(head, result_rows(one)),
        "## differences", table(head, result_rows(schema["properties"]["differences"]["items"]))])


# ---- from the sources ----------------------------------------------------------------------------------------------

def controllers_page(schema):
    controller = schema["properties"]["cobot"]["properties"]["controller"]
    rows = []
    for one in alternatives(controller):
        name = one["title"]
        source = (ROOT / "src" / "simulation" / "controllers" / f"{name}.cpp").read_text("utf-8")
        comment = re.match(r"((?:// .+\n)+)", source)
        rows.append((f"`{name}`", " ".join(comment[1].replace("// ", "").split())))
    if len(rows) < 3:
        sys.exit("the schema has too few controllers")
    return "\n\n".join([
        "# Controllers",
        "The controller of the virtual cobot, `cobot.controller` in a scenario. "
        "To write another one, see [Write a controller without changing the program](../../how-to/write-a-controller-plugin.md).",
        table(("type", "what it does"), rows), "## cobot.controller" +
        keys_page("", "", {"properties": {"cobot.controller": controller}}).partition("## cobot.controller")[2]])


def console_page(console):
    commands = [(f"`{one['command']}`", one["meaning"], "" if one["of_viewer"] else "yes") for one in console["commands"]]
    keys = [(f"{'hold' if one['held'] else 'press'} `{one['key']}`", one["meaning"]) for one in console["keys"]]
    if len(commands) < 8 or len(keys) < 5:
        sys.exit("`predictor reference console` names too few commands or keys")
    return "\n\n".join([
        "# Console commands and keys",
        "What `predictor run` accepts at its terminal. [Console](../console.md) explains how to use it.",
        "## Commands", table(("command", "what it does", "also without a viewer"), commands),
        "Ctrl-C brings the arms to rest and ends the program.",
        "## Keys with real arms", table(("key", "what it does"), [*keys, ("any other key", "**stops the arms**")])])


# The functions that read keys of `rendering` for a task or limit, and their sources.
READERS = {"LinkPairs(": "link_pairs.cpp", "TwistWeight(": "task.cpp"}


def rendering_page(schema):
    """Lists the tasks and limits with the keys of `rendering` that their sources read."""
    haptics = ROOT / "src" / "haptics"
    found = schema["properties"]["rendering"]["properties"]
    registry = (haptics / "registry.h").read_text("utf-8")
    parts, used = [
        "# Rendering tasks and limits",
        "Haptic rendering weighs the tasks against each other, and never exceeds a limit by more than its slack. "
        "The parameters are keys of `rendering` in a scenario. "
        "To write another task or limit, see [Add a limit or a task](../../developer/add-a-limit.md)."], set()
    for folder, title in (("tasks", "Task"), ("limits", "Limit")):
        listed = re.search(r"#define PREDICTOR_" + folder.upper() + r"\(add\)((?:.*\\\n)*.*)", registry)[1]
        for kind in re.findall(r"add\(k(\w+)\)", listed):
            file = haptics / folder / (re.sub(r"(?<!^)([A-Z])", r"_\1", kind).lower() + ".cpp")
            source = file.read_text("utf-8")
            name, meaning = re.search(r'KindOf<[^>]*>\(\s*"(\w+)",\s*"([^"]*)"', source).groups()
            comment = " ".join(re.match(r"((?://.*\n)+)", source)[1].replace("// ", "").replace("//", "").split())
            read = source + "".join((haptics / at).read_text("utf-8") for call, at in READERS.items() if call in source)
            own = dict.fromkeys(key for keys in re.findall(r"rendering\.(\w+)|spec\.(\w+)|setup\.(lead)\b", read)
                                for key in keys if key in found)
            if name in found:
                own[name] = None
            used |= own.keys()
            rows = [(f"`{key}`", default(found[key], False), describe(found[key])[0], allowed(found[key]),
                     describe(found[key])[1]) for key in own]
            parts += [f"## {title} {name}", meaning[0].upper() + meaning[1:] + ".", comment]
            parts += [table(("key", "default", "unit", "allowed", "meaning"), rows)] if rows else ["It has no parameters."]
    if left := found.keys() - used - {"formulation", "formulation_except"}:
        sys.exit(f"no task or limit reads these keys of rendering: {', '.join(sorted(left))}")
    return "\n\n".join(parts)


def stop_causes_page():
    text = json.loads((ROOT / "src" / "core" / "message_catalogue.json").read_text("utf-8"))
    rows = []
    for key, cause in text.items():
        found = re.fullmatch(r"stop\.(\w+)\.cause", key)
        if found:
            rows.append((f"`{found[1]}`", cause[0].upper() + cause[1:] + ".", text[f"stop.{found[1]}.advice"]))
    refusals = [(text[key],) for key in text if key.startswith("refusal.") and "{" not in text[key]]
    if len(rows) < 18 or len(refusals) < 5:
        sys.exit("message_catalogue.json names too few stop causes or refusals")
    return "\n\n".join([
        "# Stop causes and their remedies",
        "What the console, the viewer and the report say about a stop. The first column is `stop.cause` in the summary; "
        "causes that a measurement narrowed down, such as `arm_stale`, have names of their own here. "
        "Do what the remedy says, then reset. [Troubleshooting](../../getting-started/troubleshooting.md) says how.",
        table(("name", "cause", "remedy"), rows),
        "## After the power-off of an arm", text["next.unpowered"],
        "## When a request is refused",
        "The console answers an align, start, reset or recovery that it does not carry out with one of these sentences.",
        table(("answer",), refusals)])


def modules_page():
    text = (ROOT / "CMakeLists.txt").read_text("utf-8")
    found = re.findall(r"^predictor_module\((\w+)\s+([^)]*)\)", text, re.M)
    names = [name for name, _ in found]
    uses = {name: [word for word in rest.split() if word in names and word != name] for name, rest in found}
    if len(names) < 15:
        sys.exit("CMakeLists.txt names too few modules")

    def reach(name):
        return {below for direct in uses[name] for below in {direct} | reach(direct)}
    edges = [(a, b) for a in names for b in uses[a] if not any(b in reach(c) for c in uses[a] if c != b)]
    return "\n\n".join([
        "# Modules", "The libraries of `src/`. An arrow means that a module may include another one's headers; "
        "arrows that follow from others are left out. A test compares `CMakeLists.txt`, from which this is made, with the includes.",
        "```mermaid\nflowchart TD\n" + "\n".join(f"    {a} --> {b}" for a, b in edges) + "\n```",
        table(("module", "may use"), [(f"`{name}`", ", ".join(uses[name])) for name in names])])


PAGE = "<!-- Written by docs/site/generate.py. -->\n\n{}\n"


def main():
    program = str(pathlib.Path(sys.argv[1]).resolve())
    scenario = with_requirements(json_schema(program, "scenario"))
    pages = {
        "scenario": keys_page("Scenario keys", "Every key of a scenario file, from `predictor schema scenario`. "
                              "[Write a scenario](../../how-to/write-a-scenario.md) explains how they work together.", scenario),
        "machine-keys": keys_page("Machine file keys", "Every key of a machine file. "
                                  "[Machine file](../machine-file.md) explains them.", json_schema(program, "machine")),
        "command-line": command_line_page(program),
        "controllers": controllers_page(scenario),
        "recorded-quantities": quantities_page(reference(program, "quantities")),
        "console": console_page(reference(program, "console")),
        "rendering": rendering_page(scenario),
        "modules": modules_page(),
        "stop-causes": stop_causes_page(),
        "summary-json": summary_page(json_schema(program, "summary")),
        "evaluation-json": evaluation_page(json_schema(program, "evaluation"), json_schema(program, "lifting-job")),
        "check-json": check_page(json_schema(program, "check")),
        "continuation-json": continuation_page(json_schema(program, "continuation")),
        "population-json": population_page(json_schema(program, "population")),
        "cpp": "\n\n".join(["# C++ interface",
                            "The headers with which a program embeds the emulator, and those that an extension uses.",
                            *(f"## {h}\n\n```{{doxygenfile}} {pathlib.Path(h).name}\n```" for h in HEADERS)]),
    }
    PAGES.mkdir(parents=True, exist_ok=True)
    for old in PAGES.glob("*.md"):
        old.unlink()
    for name, text in pages.items():
        (PAGES / f"{name}.md").write_text(PAGE.format(text), "utf-8")


if __name__ == "__main__":
    main()
