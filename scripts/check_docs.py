#!/usr/bin/env python3
"""Checks the documentation: every relative link leads to a file and a heading, every path of the source tree that is
named exists, every symbol named beside a path stands in that file, and every stage and scene has its page."""

import pathlib
import re

from report import Report

ROOT = pathlib.Path(__file__).resolve().parent.parent
STAGES = ("sampling", "clipping", "stencils", "consistency", "stabilization", "material", "forces", "time-integration",
          "boundary", "contact", "surface", "output")
REQUIRED = ["README.md", "CHANGELOG.md", "CONTRIBUTING.md", "LICENSE", "docs/architecture.md", "docs/notation.md",
            "docs/scene.md", "docs/errata.md", *(f"docs/stages/{stage}.md" for stage in STAGES)]
TREE = "src|tests|apps|include|scenes|scripts|bench|reference|cmake|docs|studies"


def pages():
    return [ROOT / name for name in ("README.md", "CHANGELOG.md", "CONTRIBUTING.md")] + sorted((ROOT / "docs").rglob("*.md"))


def without_code(text):
    return re.sub(r"^```.*?^```", "", text, flags=re.M | re.S)


def anchors(path):
    """The anchors of a page's headings, formed as code hosting sites form them."""
    headings = re.findall(r"^#+ (.*)$", without_code(path.read_text()), re.M)
    return {re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading in headings}


def broken_links(page, text):
    for target in re.findall(r"\]\(([^)\s]+)\)", without_code(text)):
        if re.match(r"[a-z]+:", target):
            continue
        name, _, anchor = target.partition("#")
        path = (page.parent / name).resolve() if name else page
        if not path.exists():
            yield f"link to {target}"
        elif anchor and path.suffix == ".md" and anchor not in anchors(path):
            yield f"link to {target}: no such heading"


def missing_paths(text):
    """Names such as `src/forces/internal.cpp` that are no file or folder. A shell pattern names at least one."""
    for name in re.findall(rf"`((?:{TREE})/[\w./*-]*)`", text):
        if not any(ROOT.glob(name.rstrip("/"))):
            yield name


def missing_symbols(text):
    """Table rows and lists name symbols as `symbol` in `path`, or a test as `Suite.name` in `path`."""
    for symbol, name in re.findall(rf"`([\w.:]+)` in `((?:{TREE})/[\w./-]+\.(?:h|cpp|py))`", text):
        path = ROOT / name
        if path.exists() and not all(re.search(rf"\b{re.escape(word)}\b", path.read_text()) for word in re.split(r"\.|::", symbol)):
            yield f"{symbol} is not in {name}"


def main():
    report = Report()
    report.check("docs are complete", ", ".join(f"{name} is missing" for name in REQUIRED if not (ROOT / name).exists()))
    for page in pages():
        if not page.exists():
            continue
        name, text = page.relative_to(ROOT), page.read_text()
        report.check(f"links of {name}", "; ".join(broken_links(page, text)))
        report.check(f"paths of {name}", "; ".join(missing_paths(text)))
        report.check(f"symbols of {name}", "; ".join(missing_symbols(text)))
    report.finish()


if __name__ == "__main__":
    main()
