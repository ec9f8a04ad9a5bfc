"""Tests; a test mirrors the module it tests: tests/<package>/test_<module>.py."""
