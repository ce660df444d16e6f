"""Things: what else is in a world, and how it moves; one motion, one file."""
