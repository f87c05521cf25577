#!/usr/bin/env python3
"""Counts patterns of our old dialect in sources and documents. The count of a file may only fall.

    tests/language/dialect.py            fails if a file has more than tests/language/debt.txt allows
    tests/language/dialect.py FILE...    shows where they are
    tests/language/dialect.py --update   writes lower counts, and those of renamed files, into debt.txt
"""
import pathlib
import re
import subprocess
import sys

HERE = pathlib.Path(__file__).parent
ROOT = HERE.parent.parent
DEBT = HERE / "debt.txt"
SUFFIXES = {".cpp", ".h", ".ts", ".mjs", ".py", ".md", ".cmake", ".yaml", ".sh", ".cs", ".css", ".html", ".json"}
SKIPPED = re.compile(r"tests/language/|tests/.*corpus/|package-lock\.json|scenario\.schema\.json|^assets/|^models/")


def patterns():
    lines = (re.sub(r" +#.*$", "", line) for line in (HERE / "dialect.txt").read_text("utf-8").splitlines())
    return [re.compile(line) for line in lines if line and not line.startswith("#")]


def files():
    names = subprocess.run(["git", "ls-files"], cwd=ROOT, capture_output=True, text=True, check=True).stdout.split("\n")
    return [n for n in names if (pathlib.Path(n).suffix in SUFFIXES or n in ("dev", ".ci/run")) and not SKIPPED.search(n)
            and (ROOT / n).is_file()]


def found(name, words):
    text = (ROOT / name).read_text("utf-8", errors="replace")
    return [(number, match.group(0)) for number, line in enumerate(text.splitlines(), 1)
            for word in words for match in word.finditer(line)]


def debt():
    rows = (line.split() for line in DEBT.read_text("utf-8").splitlines() if line and not line.startswith("#"))
    return {name: int(count) for count, name in rows}


def write(counts):
    DEBT.write_text("# Patterns of tests/language/dialect.txt by file: written by dialect.py --update, may only fall.\n" +
                    "".join(f"{count} {name}\n" for name, count in sorted(counts.items()) if count), "utf-8")


def main(arguments):
    words = patterns()
    if arguments and arguments[0] != "--update":
        for name in arguments:
            for number, text in found(name, words):
                print(f"{name}:{number}: {text}")
        return 0
    counts = {name: len(found(name, words)) for name in files()}
    allowed = debt() if DEBT.exists() else {}
    if arguments:
        if allowed and sum(counts.values()) > sum(allowed.values()):
            print(f"The total would rise from {sum(allowed.values())} to {sum(counts.values())}.")
            return 1
        write(counts)
        return 0
    worse = [name for name in counts if counts[name] > allowed.get(name, 0)]
    for name in worse:
        for number, text in found(name, words):
            print(f"{name}:{number}: {text}")
        print(f"{name}: {counts[name]} patterns of tests/language/dialect.txt, {allowed.get(name, 0)} allowed")
    print(f"{sum(counts.values())} patterns of the old dialect are left, {sum(allowed.values())} allowed.")
    return 1 if worse else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
