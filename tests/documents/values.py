#!/usr/bin/env python3
"""Compares the table of values in docs/paper.md with the defaults of a scenario and with constants in the sources.

    values.py ROOT

The table follows the line that names this file. Each row states what the value is, where it is defined, and the value
with its unit. A value is defined by a key of the scenario, such as `safety.tracking`, or by a constant, such as
`kLinkBraking` in `src/haptics/limits/link_distance.cpp`. The unit of a key must be that of its description.
"""
import json
import pathlib
import re
import sys

DOCUMENT = "docs/paper.md"
CONSTANT = re.compile(r"`(k\w+)` in `([^`]+)`")
NUMBER = re.compile(r"-?\d+(?:\.\d+)?(?:e-?\d+)?")
UNIT = re.compile(r"\[([^\]]+)\]")


def described(schema, key):
    """Returns the description of a key, or None if there is no such key."""
    node = schema
    for name in key.split("."):
        for choice in [node] + node.get("anyOf", []):
            if name in choice.get("properties", {}):
                node = choice["properties"][name]
                break
        else:
            return None
    return node


def of_controller(schema, key):
    """Returns the description of a parameter of the Cartesian impedance controller, the paper's equation (2)."""
    kinds = schema["properties"]["cobot"]["properties"]["controller"]["anyOf"]
    kind = next(kind for kind in kinds if kind.get("title") == "cartesian_impedance")
    return described(kind, key.removeprefix("cobot.controller."))


def constant(root, name, file):
    found = re.search(rf"constexpr double {name} = ([^;]+);", (root / file).read_text(encoding="utf-8"))
    return [float(found[1])] if found else None


def numbers(value):
    values = value if isinstance(value, list) else [value]
    return [float(v) for v in values] if all(isinstance(v, (int, float)) for v in values) else None


def problem_of(root, schema, place, text):
    """Returns the error of a row, or "" for a correct row."""
    written = [float(n) for n in NUMBER.findall(text)]
    if match := CONSTANT.fullmatch(place):
        defined = constant(root, *match.groups())
        return "" if defined == written else f"the source says {defined}"
    key = place.strip("`")
    node = of_controller(schema, key) if key.startswith("cobot.controller.") else described(schema, key)
    if node is None or "default" not in node:
        return "there is no such key with a default"
    if numbers(node["default"]) != written:
        return f"the default is {node['default']}"
    unit = UNIT.search(node.get("description", ""))
    if unit and not text.endswith(" " + unit[1]):
        return f"the unit is {unit[1]}"
    return ""


def main():
    root = pathlib.Path(sys.argv[1])
    schema = json.loads((root / "scenarios" / "scenario.schema.json").read_text(encoding="utf-8"))
    lines = (root / DOCUMENT).read_text(encoding="utf-8").split("\n")
    begin = next(i for i, line in enumerate(lines) if "tests/documents/values.py" in line) + 3
    compared = failed = 0
    for i in range(begin, len(lines)):
        if not lines[i].startswith("|"):
            break
        _, place, text = (cell.strip() for cell in lines[i].strip("|").split("|"))
        compared += 1
        if problem := problem_of(root, schema, place, text):
            failed += 1
            print(f"{DOCUMENT}:{i + 1}: {place} is {text}, but {problem}.")
    print(f"{compared} values compared, {failed} errors.")
    return 1 if failed or not compared else 0


if __name__ == "__main__":
    sys.exit(main())
