"""Checks before running, a few to a file. Each takes a `Reach` and gives diagnostics; see rplan/ways/coverage.py."""
