"""The rigid chain, measured: fits, planned and stable poses, relations, nearly rigid arms."""
