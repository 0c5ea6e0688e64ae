#!/usr/bin/env python3
"""What the pages show is in an example that runs: quotes_test.py SOURCE_FOLDER prints every quote that is not, and every
example that no page names, and fails."""
import pathlib
import re
import sys

# Those that quote; docs/exploration.md sketches loops around robots of its reader's.
PAGES = ["README.md", "docs/engine.md", "docs/python.md"]


def lines_of(text):
    """Without indentation."""
    return [line.strip() for line in text.strip().split("\n")]


def contains(example, quote):
    """Whether an example has all paragraphs of a quote, each in one piece."""
    lines = lines_of(example)
    parts = [lines_of(part) for part in re.split(r"\n\s*\n", quote.strip())]
    return all(any(lines[i:i + len(part)] == part for i in range(len(lines))) for part in parts)


def main():
    root = pathlib.Path(sys.argv[1])
    examples = {file: file.read_text(encoding="utf-8") for file in sorted((root / "docs/examples").iterdir())
                if file.suffix in (".cpp", ".py")}
    complaints, quotes = [], 0
    for page in PAGES:
        for code in re.findall(r"```(?:cpp|python)\n(.*?)```", (root / page).read_text(encoding="utf-8"), re.DOTALL):
            quotes += 1
            if not any(contains(example, code) for example in examples.values()):
                complaints.append(f"{page}: no example has this:\n{code}")
    pages = [root / "README.md", *(root / "docs").glob("*.md")]
    everything = "".join(page.read_text(encoding="utf-8") for page in pages)
    complaints += [f"no page names {file.relative_to(root)}" for file in examples if f"examples/{file.name}" not in everything]
    if complaints or quotes < len(PAGES):
        sys.exit("\n".join(complaints) or f"only {quotes} quotes")
    print(f"{quotes} quotes are in {len(examples)} examples")


if __name__ == "__main__":
    main()
