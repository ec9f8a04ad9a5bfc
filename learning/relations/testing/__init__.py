"""Tests of candidate relations against samples."""
