"""Files of the learner: saved models, samples as CSV, software versions."""
