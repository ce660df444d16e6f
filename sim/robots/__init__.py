"""Robots: what drives and what looks, each driven by one actuator of a `Command`."""
