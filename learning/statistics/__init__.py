"""Statistics of samples that every learner and every claim needs: poses, lack of fit."""
