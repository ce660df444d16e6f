"""Sensors: from the truth and some chance to one part of a `Reading`; one sensor, one file."""
