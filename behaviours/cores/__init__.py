"""Pure algorithms: numbers in, numbers out, each with its source."""
