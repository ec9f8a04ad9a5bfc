"""Tests; a test mirrors the module it tests."""
