"""The forms of the language, a kind to a file. Each parser takes a `Scope` and a form; see rplan/lang/parse.py."""
