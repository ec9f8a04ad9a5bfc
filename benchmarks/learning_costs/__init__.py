"""Times of the learners: updates, predictions and batch fits, beside other learners."""
