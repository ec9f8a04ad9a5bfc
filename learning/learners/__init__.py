"""Learners of the inverse statics model, each with the scikit-learn interface."""
