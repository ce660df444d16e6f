"""Scenarios: from YAML to frozen values, and from those and a seed to where everything stands."""
