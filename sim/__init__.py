"""A world to do a task in: `Reading` out, `Command` in.

`scenarios.scenario.load` reads a scenario, `episode.run` runs any brain in it and judges the run, `recording` and
`replay` keep it. Nothing here knows a plan or a behaviour.
"""
