"""The SQLite file of a recording: schema, queries, lock, commits and checks."""
