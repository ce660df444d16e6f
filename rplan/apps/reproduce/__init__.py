"""The experiments that papers report, run again: the paper's figure beside ours, with a verdict."""
