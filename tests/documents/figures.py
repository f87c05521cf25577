#!/usr/bin/env python3
"""Compares the figures in README.md and docs/ with docs/numbers.csv, which `predictor reproduce` writes.

    figures.py ROOT             checks that every figure equals its number, rounded as printed; otherwise exits with 1
    figures.py ROOT --update    writes the figures into the documents instead
    figures.py ROOT --program P checks the output of `P simulate` that the page of the first run quotes

A table names its source in the line before it:

    <!-- figures: EXPERIMENT | COLUMN | COLUMN -->

for the columns after the first. The first cell of a row is `QUANTITY [UNIT]`; with the prefix `9 kg: ` or `18 kg: `, it
refers to box_9kg or box_18kg. A COLUMN is `paper`, `CONDITION`, or `CONDITION [STYLE]`:

    (none)     mean ± deviation (largest)      [mean]   mean, three digits
    [± only]   mean ± deviation                [ratio]  to the paper's mean
    [RMSE]     RMSE (correlation) of the circle [range] of the circle

A table with figures from another source is marked <!-- figures not from reproduce: SOURCE -->, and one without figures
<!-- no results -->. In a sentence, the source follows the figure:
14.7<!-- EXPERIMENT | CONDITION [STYLE] | QUANTITY [UNIT] -->.
"""
import csv
import math
import pathlib
import re
import subprocess
import sys

OUTPUT = "docs/getting-started/first-run.md"
DOCUMENTS = ["README.md", "docs/paper.md", "docs/concepts/reproduction.md", "docs/concepts/accuracy.md", "docs/how-to/identify-friction.md"]
PREFIXES = {"9 kg": "box_9kg", "18 kg": "box_18kg"}
TABLE = re.compile(r"<!-- figures: (.*) -->$")
ELSEWHERE = re.compile(r"<!-- (figures not from reproduce: .+|no results) -->$")
INLINE = re.compile(r"(?P<figure>[\d.]+(?: ± [\d.]+)?(?: \([\d.]+\))?)<!-- (?P<source>[^>|]+\|[^>]+\|[^>]+) -->")
STYLE = re.compile(r"^(.*?)(?: \[([^\]]+)\])?$")


class Missing(Exception):
    pass


def read_numbers(file):
    with open(file, encoding="utf-8") as rows:
        return {(r["experiment"], r["quantity"], r["unit"], r["condition"]): r for r in csv.DictReader(rows)}


def fixed(value, decimals):
    return f"{value:.{decimals}f}"


def significant(value, digits):
    if value == 0:
        return "0"
    return fixed(value, max(0, digits - 1 - math.floor(math.log10(abs(value)))))


def plus_minus(mean, deviation):
    """Formats with two significant digits of the smaller one and at most four decimals, as the program does."""
    least = min(x for x in (abs(mean), deviation) if x > 0) if mean or deviation else 0
    decimals = min(4, max(0, 1 - math.floor(math.log10(least)))) if least else 1
    return f"{fixed(mean, decimals)} ± {fixed(deviation, decimals)}"


def number(row, key):
    if not row[key]:
        raise Missing(f"has no {key}")
    return float(row[key])


def styled(row, style):
    if style == "mean":
        return significant(number(row, "mean"), 3)
    if style == "ratio":
        return significant(number(row, "ratio"), 2) if row["ratio"] else "–"
    text = plus_minus(number(row, "mean"), number(row, "deviation")) if row["deviation"] else \
        significant(number(row, "mean"), 3)
    if style is None and row["largest"]:
        text += f" ({significant(number(row, 'largest'), 2)})"
    return text


class Numbers:
    def __init__(self, rows):
        self.rows = rows

    def find(self, experiment, quantity, unit, condition):
        row = self.rows.get((experiment, quantity, unit, condition))
        if row is None:
            raise Missing(f"there is no {experiment} | {condition} | {quantity} [{unit}]")
        return row

    def paper(self, experiment, quantity, unit):
        for (e, q, u, _), row in self.rows.items():
            if (e, q, u) == (experiment, quantity, unit) and row["paper_mean"]:
                decimals = max(1, *(len(row[k].partition(".")[2]) for k in ("paper_mean", "paper_deviation")))
                return " ± ".join(fixed(float(row[k]), decimals) for k in ("paper_mean", "paper_deviation"))
        return "–"

    def figure(self, experiment, column, label):
        """Returns the text of a cell, or `–` if this condition lacks the quantity but another condition has it."""
        quantity, unit = re.fullmatch(r"(.*) \[(.*)\]", label).groups()
        condition, style = STYLE.fullmatch(column).groups()
        if condition == "paper":
            return self.paper(experiment, quantity, unit)
        if style == "RMSE":
            rmse = self.find(experiment, f"{quantity}, RMSE", unit, condition)
            correlation = self.find(experiment, f"{quantity}, correlation", "1", condition)
            return f"{fixed(number(rmse, 'mean'), 2)} ({fixed(number(correlation, 'mean'), 3)})"
        if style == "range":
            return significant(number(self.find(experiment, f"{quantity}, range", unit, condition), "mean"), 3)
        try:
            return styled(self.find(experiment, quantity, unit, condition), style)
        except Missing:
            if not any(key[:3] == (experiment, quantity, unit) for key in self.rows):
                raise
            return "–"


def cells_of(line):
    return [cell.strip() for cell in line.strip().strip("|").split("|")]


def plain(cell):
    return cell.replace("*", "").replace("`", "")


class Document:
    """Returns a document's lines with the correct figures, and its errors."""

    def __init__(self, name, text, numbers):
        self.name, self.numbers = name, numbers
        self.errors, self.compared = [], 0
        self.lines = text.split("\n")
        self.inline()
        self.tables()

    def error(self, line, words):
        self.errors.append(f"{self.name}:{line + 1}: {words}")

    def inline(self):
        for i, line in enumerate(self.lines):
            def renewed(match, i=i):
                experiment, column, label = (part.strip() for part in match["source"].split("|"))
                try:
                    text = self.numbers.figure(experiment, column, label)
                except (Missing, AttributeError) as missing:
                    self.error(i, f"{match['source']}: {missing}")
                    return match[0]
                self.compared += 1
                return f"{text}<!-- {match['source']} -->"
            self.lines[i] = INLINE.sub(renewed, line)

    def tables(self):
        fenced, i = False, 0
        while i < len(self.lines):
            fenced ^= self.lines[i].startswith("```")
            if fenced or not self.lines[i].startswith("|"):
                i += 1
                continue
            end = i
            while end < len(self.lines) and self.lines[end].startswith("|"):
                end += 1
            self.table(i, end)
            i = end

    def table(self, begin, end):
        before = self.lines[begin - 1] if begin else ""
        directive = TABLE.match(before)
        if directive:
            return self.renew(begin + 2, end, [part.strip() for part in directive[1].split("|")])
        figures = any(re.search(r"\d", " ".join(cells_of(line)[1:])) for line in self.lines[begin + 2:end])
        if figures and not ELSEWHERE.match(before):
            self.error(begin, "a table with figures, but no line before it that names their source")

    def renew(self, begin, end, source):
        for i in range(begin, end):
            cells = cells_of(self.lines[i])
            if len(cells) != len(source):
                self.error(i, f"{len(cells)} cells, but the source names {len(source) - 1} columns after the first")
                continue
            label, experiment = plain(cells[0]), source[0]
            prefix, found, rest = label.partition(": ")
            if found and prefix in PREFIXES:
                label, experiment = rest, PREFIXES[prefix]
            try:
                new = [cells[0]] + [self.numbers.figure(experiment, column, label) for column in source[1:]]
            except (Missing, AttributeError) as missing:
                self.error(i, f"{missing}" if isinstance(missing, Missing) else "the first cell is not QUANTITY [UNIT]")
                continue
            self.compared += len(new) - 1
            if new != cells:
                self.lines[i] = "| " + " | ".join(new) + " |"


def check_documents(root, update):
    numbers = Numbers(read_numbers(root / "docs" / "numbers.csv"))
    failed = compared = 0
    for name in DOCUMENTS:
        if not (root / name).exists():
            continue
        old = (root / name).read_text(encoding="utf-8")
        document = Document(name, old, numbers)
        errors, new = document.errors, "\n".join(document.lines)
        if update:
            (root / name).write_text(new, encoding="utf-8")
        else:
            for i, (a, b) in enumerate(zip(old.split("\n"), document.lines)):
                if a != b:
                    document.error(i, f"says\n  {a}\nbut docs/numbers.csv gives\n  {b}")
        compared += document.compared
        failed += len(errors)
        for error in errors:
            print(error)
    print(f"{compared} figures compared, {failed} errors.")
    return 1 if failed or not compared else 0


# ---- the output of the program in a page ---------------------------------------------------------------------------

# These values depend on the computer.
BY_THE_CLOCK = re.compile(r"times real time|^Time per tick|^  (read|sense|simulate|render|monitor|guard|write|tick) ")
FIGURE = re.compile(r"\d+(?:\.\d+)?")


def close(a, b):
    """Returns whether the values differ by at most 3 % or two units of the last printed digit, as between processors."""
    digit = 10.0 ** -len(a.partition(".")[2])
    return abs(float(a) - float(b)) <= max(0.03 * abs(float(b)), 2.001 * digit)


def check_output(root, program):
    blocks = re.findall(r"<!-- output: simulate (\S+) -->\n```text\n(.*?)```", (root / OUTPUT).read_text("utf-8"), re.S)
    if not blocks:
        print(f"{OUTPUT} has no block after <!-- output: simulate SCENARIO -->")
        return 1
    failed = 0
    for scenario, block in blocks:
        run = subprocess.run([program, "simulate", scenario], cwd=root, check=True, capture_output=True, text=True)
        printed = [line for line in run.stderr.split("\n") if re.match("Device  |Lag compensation", line)]
        printed += run.stdout.rstrip("\n").split("\n")
        quoted = block.rstrip("\n").split("\n")
        if len(printed) != len(quoted):
            print(f"{OUTPUT} quotes {len(quoted)} lines, the program prints {len(printed)}")
            failed += 1
        for a, b in zip(quoted, printed):
            if BY_THE_CLOCK.search(b) and BY_THE_CLOCK.search(a):
                continue
            same = FIGURE.sub("#", a).split() == FIGURE.sub("#", b).split() and \
                all(close(x, y) for x, y in zip(FIGURE.findall(a), FIGURE.findall(b)))
            if not same:
                print(f"{OUTPUT}: {a}\nthe program: {b}")
                failed += 1
    return 1 if failed else 0


def main():
    root = pathlib.Path(sys.argv[1])
    if "--program" in sys.argv:
        return check_output(root, sys.argv[sys.argv.index("--program") + 1])
    return check_documents(root, "--update" in sys.argv)


if __name__ == "__main__":
    sys.exit(main())
