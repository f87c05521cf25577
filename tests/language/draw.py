#!/usr/bin/env python3
"""Draws sentences of docs, comments and messages for a reader who judges them without knowing their origin.

    draw.py SEED COUNT COMMIT OLD LIST KEY   draws COUNT sentences of COMMIT, and 20 of the commit OLD that COMMIT lacks

LIST contains the shuffled sentences. KEY contains their numbers, their state (new or old), their files and the sentences.
"""
import pathlib
import random
import re
import subprocess
import sys

SHARES = (("docs", 0.4, 8), ("comments", 0.4, 8), ("messages", 0.2, 4))  # of the new sentences; number of old ones


def git(*arguments):
    return subprocess.run(["git", *arguments], capture_output=True, check=True).stdout.decode("utf-8", "replace")


def sentences(text):
    for paragraph in re.split(r"\n\s*\n", text):
        for sentence in re.split(r'(?<=[.!?])\s+(?=[A-Z`"*\[(])', " ".join(paragraph.split())):
            if 5 <= len(sentence.split()) <= 60 and re.match(r'^[A-Z`*"\[(]', sentence) and sentence[-1] in ".!?":
                yield sentence


def of_document(text):
    text = re.sub(r"```.*?```|<!--.*?-->", "", text, flags=re.S)
    return sentences("\n".join("" if re.match(r"\s*(\||#|:::)", line) else re.sub(r"^\s*([-*]|\d+\.)\s+", "\n\n", line)
                               for line in text.split("\n")))


def of_comments(text):
    block = []
    for line in [*text.split("\n"), ""]:
        comment = re.match(r"\s*//+ ?(.*)", line)
        if comment:
            block.append(comment[1])
            continue
        yield from sentences("\n".join(block))
        block = []


def of_messages(text):
    for literal in re.finditer(r'"((?:[^"\\\n]|\\.){30,400})"', re.sub(r'"\s*\n\s*"', "", text)):
        yield from sentences(literal[1].replace("\\n", " "))


def collect(commit):
    """Returns the sentences of a commit, with their files, by their origin."""
    pool = {"docs": [], "comments": [], "messages": []}
    for name in git("ls-tree", "-r", "--name-only", commit).split():
        if "corpus" in name or name.startswith(("tests/language", "assets", "models")):
            continue
        if name.endswith(".md") and (name.startswith("docs/") or "/" not in name):
            pool["docs"] += [(s, name) for s in of_document(git("show", f"{commit}:{name}"))]
        if name.endswith((".cpp", ".h", ".ts")):
            text = git("show", f"{commit}:{name}")
            pool["comments"] += [(s, name) for s in of_comments(text)]
            if name.startswith(("src/", "apps/", "web/")):
                pool["messages"] += [(s, name) for s in of_messages(text)]
    return pool


def main(seed, count, commit, old, listing, key):
    draw, new, before = random.Random(int(seed)), collect(commit), collect(old)
    present = {sentence for pool in new.values() for sentence, _ in pool}
    picked = []
    for origin, share, _ in SHARES:
        picked += [(*it, "new") for it in draw.sample(sorted(set(new[origin])), round(int(count) * share))]
    for origin, _, number in SHARES:
        gone = sorted({it for it in before[origin] if it[0] not in present})
        picked += [(*it, "old") for it in draw.sample(gone, number)]
    draw.shuffle(picked)
    pathlib.Path(listing).write_text("".join(f"{i}. {it[0]}\n" for i, it in enumerate(picked, 1)), "utf-8")
    pathlib.Path(key).write_text("".join(f"{i}\t{state}\t{file}\t{sentence}\n"
                                         for i, (sentence, file, state) in enumerate(picked, 1)), "utf-8")


if __name__ == "__main__":
    main(*sys.argv[1:])
