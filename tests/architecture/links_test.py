#!/usr/bin/env python3
"""Links of the documents to files and headings of the repository lead somewhere."""
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]


def anchors(page):
    return {re.sub(r"[^\w\- ]", "", title.lower()).replace(" ", "-") for title in re.findall(r"^#+ (.*)", page.read_text(), re.MULTILINE)}


def main():
    faults = []
    pages = [page for page in ROOT.rglob("*.md") if not re.match(r"(build|out|\.)", page.relative_to(ROOT).parts[0])]
    for page in pages:
        text = re.sub(r"^```.*?^```", "", page.read_text(), flags=re.MULTILINE | re.DOTALL)
        for link in re.findall(r"\]\(([^)\s]+)\)", text):
            path, _, heading = link.partition("#")
            target = page.parent / path if path else page
            if re.match(r"\w+:", link) or (target.exists() and (not heading or target.suffix != ".md" or heading in anchors(target))):
                continue
            faults.append(f"{page.relative_to(ROOT)}: {link}")
    print("\n".join(faults) or f"{len(pages)} documents")
    return len(faults) > 0


if __name__ == "__main__":
    sys.exit(main())
