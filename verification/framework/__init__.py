"""Common parts of the studies: runs of the program, Exodus files, checks against exact answers,
plots and reports."""
