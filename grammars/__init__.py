"""The grammar of the `.sketch` language, kept apart from the code that reads it."""
