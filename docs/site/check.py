#!/usr/bin/env python3
"""Checks the pages: check.py ROOT PROGRAM [PAGE...].

Links: each relative link in a Markdown file of the repository must lead to an existing file and heading, and each path
of the repository in code type must exist.

Code: blocks of `sh` and `python` are run in the order of their page, in a separate folder that contains the repository's
scenarios, assets and docs, with PROGRAM on the path. A word after the language changes this:

    ```sh hardware    needs a robot: counted, but not run
    ```sh long        takes minutes, builds, or waits for a person: counted, but not run
    ```sh fails       must end with an exit code other than 0
    ```yaml file=NAME is written to NAME first (any language)
"""
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

FENCE = re.compile(r"^( *)(`{3,}|~{3,}|:{3,})(.*)$")
LINK = re.compile(r"!?\[[^\]]*\]\(([^)\s]+)\)")
PATH = re.compile(r"`((?:src|apps|tests|docs|scenarios|assets|deps|web|unity|models|bench|cmake|examples)/[\w./-]+)`")
SKIPPED = ("hardware", "long")
RUN = {"sh": ["bash", "-euo", "pipefail", "-c"], "python": [sys.executable, "-c"]}
# A build writes these files, or the reader who follows a page.
MADE = re.compile(r"^(web/(dist|node_modules)|docs/reference/generated|src/(simulation/controllers/viscous_guiding|evaluation/metrics/handle_speed|haptics/limits/handle_height|haptics/tasks/rest_posture|scenario/actions/shake)|scenarios/(mine\w*|my_cobot)\.(yaml|csv))")


def blocks(text):
    """Returns (line, info, code) of each fenced block, and the text with the blocks blanked."""
    found, prose, fence = [], [], None
    for i, line in enumerate(text.split("\n"), 1):
        match = FENCE.match(line)
        if fence is None and match:
            fence, info, start, code, indent = match[2], match[3].strip(), i, [], len(match[1])
        elif fence is not None and line.strip() == fence:
            found.append((start, info, "\n".join(code) + "\n"))
            fence = None
        elif fence is not None:
            code.append(line[indent:] if not line[:indent].strip() else line)
        else:
            prose.append(line)
            continue
        prose.append("")
    return found, "\n".join(prose)


def slug(heading):
    heading = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", heading)
    return re.sub(r"[^\w\- ]", "", heading.strip().lower()).replace(" ", "-")


def anchors(text):
    names = {}
    for heading in re.findall(r"^#{1,6} +(.*?)\s*$", blocks(text)[1], re.M):
        name = slug(heading.replace("`", ""))
        names[name] = names.get(name, -1) + 1
    return {n if k == 0 else f"{n}-{k}" for n, most in names.items() for k in range(most + 1)}


def check_links(root, files):
    errors, count = [], 0
    for file in files:
        _, prose = blocks(file.read_text("utf-8"))
        for i, line in enumerate(prose.split("\n"), 1):
            where = f"{file.relative_to(root)}:{i}"
            for link in LINK.findall(re.sub(r"`[^`]*`", "", line)):
                if re.match(r"[a-z]+:", link):
                    continue
                count += 1
                name, _, anchor = link.partition("#")
                target = (file.parent / name).resolve() if name else file
                if not target.exists():
                    errors.append(f"{where}: {link} does not exist")
                elif anchor and anchor not in anchors(target.read_text("utf-8")):
                    errors.append(f"{where}: {link}: no such heading")
            if file.name == "CHANGELOG.md":
                continue
            for path in PATH.findall(line):
                count += 1
                if not MADE.match(path) and not (root / path).exists() and not (file.parent / path).exists() and not list(root.glob(path + ".*")):
                    errors.append(f"{where}: `{path}` does not exist")
    return errors, count


def folder_for(root, program, folder):
    for name in ("scenarios", "assets", "docs", "examples", "README.md"):
        if (root / name).exists():
            shutil.copytree(root / name, folder / name, symlinks=True) if (root / name).is_dir() else \
                shutil.copy(root / name, folder / name)
    (folder / "bin").mkdir()
    (folder / "bin" / "predictor").symlink_to(program)
    python = pathlib.Path(sys.executable).parent
    return {**os.environ, "PATH": f"{folder}/bin:{python}:{os.environ['PATH']}", "TERM": "dumb", "NO_COLOR": "1"}


def check_code(root, program, file):
    errors, ran, skipped = [], 0, dict.fromkeys(SKIPPED, 0)
    found, _ = blocks(file.read_text("utf-8"))
    with tempfile.TemporaryDirectory() as name:
        folder, environment = pathlib.Path(name), None
        for line, info, code in found:
            where = f"{file.relative_to(root)}:{line}"
            language, *marks = info.split() or [""]
            for mark in marks:
                if mark.startswith("file="):
                    environment = environment or folder_for(root, program, folder)
                    target = folder / mark[5:]
                    target.parent.mkdir(parents=True, exist_ok=True)
                    target.write_text(code, "utf-8")
                elif mark not in (*SKIPPED, "fails") and language in RUN:
                    errors.append(f"{where}: unknown mark '{mark}'")
            if not language:
                errors.append(f"{where}: a block without a language; use text if no other fits")
            marked = [mark for mark in marks if mark in SKIPPED]
            if language not in RUN or any(mark.startswith("file=") for mark in marks):
                continue
            if marked:
                skipped[marked[0]] += 1
                continue
            environment = environment or folder_for(root, program, folder)
            done = subprocess.run([*RUN[language], code], cwd=folder, env=environment, text=True, check=False,
                                  stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, timeout=300)
            ran += 1
            if (done.returncode != 0) != ("fails" in marks):
                errors.append(f"{where}: ended with {done.returncode}:\n{done.stdout[-2000:]}")
    return errors, ran, skipped


def main():
    root, program = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]).resolve()
    listed = subprocess.run(["git", "ls-files", "-co", "--exclude-standard", "*.md"], cwd=root, text=True,
                            capture_output=True, check=True).stdout.split()
    files = [root / name for name in listed if (root / name).exists()]
    errors, links = check_links(root, files)
    ran, skipped = 0, dict.fromkeys(SKIPPED, 0)
    only = sys.argv[3:]
    for file in files:
        relative = str(file.relative_to(root))
        if not (relative == "README.md" or relative.startswith("docs/")) or (only and relative not in only):
            continue
        more, n, kinds = check_code(root, program, file)
        errors += more
        ran += n
        for kind in kinds:
            skipped[kind] += kinds[kind]
    for error in errors:
        print(error)
    print(f"{links} links and paths, {ran} code blocks run, " +
          ", ".join(f"{count} skipped as {kind}" for kind, count in skipped.items()) + f"; {len(errors)} errors.")
    return 1 if errors else 0


if __name__ == "__main__":
    sys.exit(main())
