"""What several benchmarks use: arms, tables in documents, time limits, clear errors."""
