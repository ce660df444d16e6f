"""What lasts: estimators take every reading, whoever drives."""
