"""Common parts of the studies: runs of the program, Exodus files, checks against exact answers,
plots and reports."""
import sys
from pathlib import Path

# The reader of Exodus files and the style of plots are those of brickwall-plot; machine, child
# processes, run folders and Markdown tables are those of `brickwall study`.
for part in ("plot", "study"):
    sys.path.append(str(Path(__file__).resolve().parents[2] / "miniapp" / part))
