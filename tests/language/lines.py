#!/usr/bin/env python3
"""Checks the lines of Markdown files: a line is one sentence, or has at most 100 columns.

lines.py [--fix] [FILE...]; without files, all Markdown files of the repository. With --fix, every
sentence of a line that is too long begins a new line. Tables, headings and code may be longer.
"""
import pathlib
import re
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
COLUMNS = 100
FENCE = re.compile(r"^[\s>]*(`{3,}|~{3,})")
NOT_PROSE = re.compile(r"^\s*(\||#|<|:::|\[[^\]]+\]:\s|!\[)")
START = re.compile(r"^(\s*(?:>\s?)*)((?:[-*+]|\d+[.)])\s+)?")  # quotation and indentation, and mark of an item
END = re.compile(r"(?<=[.!?])([\"'’”)*_]*)\s+(?=[\"'“‘(*_]*[A-Z0-9])")
ABBREVIATION = re.compile(r"(?:\b(?:e\.g|i\.e|cf|vs|al|Fig|Figs|Eq|No|Dr|approx|ca|pp|p|Sec|Ch|St)|\b[A-Z])\.$")
MARK = re.compile(r"^(?:[-+*>#]|\d+[.)])\s")


def sentences(line):
    """Returns the sentences of a line. Code and links do not contain an end."""
    hidden = re.sub(r"`[^`]*`|!?\[[^\]]*\]\([^)]*\)", lambda found: "X" * len(found[0]), line)
    parts, begin = [], 0
    for end in END.finditer(hidden):
        if ABBREVIATION.search(hidden[begin:end.start()]) or MARK.match(line[end.end():]):
            continue
        parts.append(line[begin:end.end()].rstrip())
        begin = end.end()
    return [*parts, line[begin:]]


def broken(line):
    """Returns the lines by which a line is replaced: itself, if it is permitted."""
    if len(line) <= COLUMNS or NOT_PROSE.match(line):
        return [line]
    quote, item = START.match(line).groups(default="")
    first, *others = sentences(line[len(quote + item):])
    return [quote + item + first, *(quote + " " * len(item) + other for other in others)]


def lines_of(text):
    """Returns (number, line, lines that replace it) of each line."""
    fence, out = None, []
    for number, line in enumerate(text.split("\n"), 1):
        mark = FENCE.match(line)
        if mark and (fence is None or (mark[1].startswith(fence) and line.strip(" >") == mark[1])):
            fence = mark[1] if fence is None else None
            out.append((number, line, [line]))
        else:
            out.append((number, line, [line] if fence else broken(line)))
    return out


def self_test():
    long = "A first sentence that names `a.b. C` and e.g. Foxglove. "
    text = f"- {long}{long}Then [a link. It](to) ends.\n\n```text\n{long}{long}{long}\n```\n| {long}{long} |\n"
    replaced = [new for _, _, news in lines_of(text) for new in news]
    expected = [f"- {long.strip()}", f"  {long.strip()}", "  Then [a link. It](to) ends.", *text.split("\n")[1:]]
    if replaced != expected:
        sys.exit("tests/language/lines.py breaks its own sample wrongly: " + "\n".join(replaced))


def main():
    self_test()
    fix = "--fix" in sys.argv[1:]
    names = [name for name in sys.argv[1:] if name != "--fix"] or subprocess.run(
        ["git", "ls-files", "-co", "--exclude-standard", "*.md"], cwd=ROOT, capture_output=True, text=True,
        check=True).stdout.split()
    wrong = 0
    for name in names:
        file = ROOT / name
        found = lines_of(file.read_text("utf-8"))
        for number, _, news in found:
            if len(news) > 1 and not fix:
                print(f"{name}:{number}: more than {COLUMNS} columns and {len(news)} sentences")
            wrong += len(news) > 1
        if fix:
            file.write_text("\n".join(new for _, _, news in found for new in news), "utf-8")
    if wrong and not fix:
        sys.exit(f"{wrong} lines are too long: `tests/language/lines.py --fix` breaks them.")


if __name__ == "__main__":
    main()
