"""The version: packages, ``isotorque.__version__`` and results take it from here."""

VERSION = "0.2.0"
