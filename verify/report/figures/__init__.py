"""Figures as pure functions from arrays to Matplotlib figures."""

from isotorque.verify.report.figures.matplotlib_folder import give_matplotlib_a_folder

give_matplotlib_a_folder()  # before it is imported, which is when it looks for one
