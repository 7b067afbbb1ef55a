#!/usr/bin/env python3
"""The lists of files in CONTRIBUTING.md: each file exists, and each source file that names an existing extension is listed."""
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
# What the source files with a place for one more material, pulse, parameter or method contain.
PATTERNS = {"Adding a material": r"MaterialModel::svk|\bsaintVenantKirchhoff\b", "Adding a load": r"PulseKind::triangle",
            "Adding a contact law": r"\bfriction_stiffness\b", "Adding a search method": r"SearchMethod::reference"}


def main():
    faults = []
    sources = [path.relative_to(ROOT).as_posix() for folder in ("contact", "mechanics", "io", "miniapp", "tests")
               for path in (ROOT / folder).rglob("*") if path.suffix in (".hpp", ".cpp", ".py", ".txt", ".sh")]
    for title, section in re.findall(r"^## (.*?)\n(.*?)(?=^## |\Z)", (ROOT / "CONTRIBUTING.md").read_text(), re.MULTILINE | re.DOTALL):
        # A name without folders stands "beside" a file with them; <model> is any word.
        named = [name.replace("<model>", "*") for name in re.findall(r"`([\w./<>-]+\.(?:hpp|cpp|py|txt|sh))`", section)]
        found = {name: [path for path in sources if pathlib.PurePath(path).match(name)] for name in named}
        faults += [f"{title}: {name} does not exist" for name in named if not found[name] and not (ROOT / name).exists()]
        listed = set().union(*found.values())
        if title in PATTERNS:
            faults += [f"{title}: {path} is not listed" for path in sources if not path.startswith("tests/") and path not in listed
                       and path.endswith("pp") and re.search(PATTERNS[title], (ROOT / path).read_text())]
    missing = [title for title in PATTERNS if f"## {title}\n" not in (ROOT / "CONTRIBUTING.md").read_text()]
    faults += [f"CONTRIBUTING.md has no section {title}" for title in missing]
    print("\n".join(faults) or "all files are listed")
    return len(faults) > 0


if __name__ == "__main__":
    sys.exit(main())
