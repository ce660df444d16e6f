"""Text to `Plan`. Takes: a source text. Gives: syntax with places, or errors. Leaves alone: what names mean."""
