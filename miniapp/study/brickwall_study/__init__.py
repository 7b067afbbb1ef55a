"""Comparison of runs and studies of many runs; see README.md beside this folder. Only Python's standard library is needed."""
