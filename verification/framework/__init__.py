"""What the studies share: runs of the program, Exodus files, cases with exact answers, plots and reports."""
