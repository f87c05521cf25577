"""The documentation site: Sphinx reads docs/ as plain Markdown (MyST). `./dev docs` runs it."""
import pathlib
import re

ROOT = pathlib.Path(__file__).resolve().parents[2]

project = "PREDICTOR"
author = "The PREDICTOR contributors"
copyright = author
extensions = ["myst_parser", "breathe", "sphinx_copybutton"]
root_doc = "index"
source_suffix = {".md": "markdown"}
exclude_patterns = ["site"]

html_theme = "furo"
html_title = "PREDICTOR"
html_show_sphinx = False
html_copy_source = False
html_theme_options = {"navigation_with_keys": True}

myst_enable_extensions = ["colon_fence", "deflist"]
myst_heading_anchors = 4
copybutton_exclude = ".linenos, .gp, .go"

breathe_projects = {"predictor": str(ROOT / "build" / "docs" / "doxygen" / "xml")}
breathe_default_project = "predictor"
breathe_show_include = False
# Sphinx's C++ parser does not support these words in the sources.
cpp_id_attributes = ["EIGEN_ALIGN16"]
suppress_warnings = ["duplicate_declaration.cpp"]  # the namespace, once for each header

# The diagrams are written in Mermaid, which repository hosts draw. Here Graphviz draws them, so
# that no external script is needed.
extensions.append("sphinx.ext.graphviz")
graphviz_output_format = "svg"
graphviz_dot_args = ["-Gbgcolor=transparent", "-Nfontname=sans-serif", "-Efontname=sans-serif", "-Nfontsize=11",
                     "-Efontsize=9", "-Nshape=box", "-Nstyle=rounded,filled", "-Nfillcolor=#e8eef7"]


def to_graphviz(match):
    """Converts a Mermaid state diagram or flowchart of plain `A --> B: label` edges to Graphviz."""
    kind, *lines = match[1].strip().split("\n")
    out = ["digraph {", "rankdir=" + (kind.split()[1] if kind.startswith("flowchart") else "TB").replace("TD", "TB")]
    for line in (text.strip() for text in lines):
        state = re.fullmatch(r'state "(.+)" as (\w+)', line)
        node = re.fullmatch(r'(\w+)\["(.+)"\]', line)
        edge = re.fullmatch(r"(\w+|\[\*\]) -->(?:\|(.+)\|)? (\w+|\[\*\])(?:: (.+))?", line)
        if state or node:
            name, label = (state[2], state[1]) if state else (node[1], node[2])
            out.append(f'{name} [label="{label}"]'.replace("<br>", "\\n"))
        elif edge:
            label = (edge[2] or edge[4] or "").replace(", ", ",\\n")
            ends = ["start" if end == "[*]" else end for end in (edge[1], edge[3])]
            out += ['start [shape=point]'] if "start" in ends else []
            out.append(f'{ends[0]} -> {ends[1]} [label="{label}"]')
        elif line:
            raise ValueError(f"a Mermaid line that to_graphviz does not know: {line}")
    return "```{graphviz}\n" + "\n".join([*out, "}"]) + "\n```"


def draw(app, document, source):
    source[0] = re.sub(r"^```mermaid\n(.*?)^```", to_graphviz, source[0], flags=re.S | re.M)


def setup(app):
    app.connect("source-read", draw)
