"""Many episodes of one plan: every combination of scenarios, parameter values and seeds, as rows of a table."""
