"""Drive files: their schema, and drives from them and back."""
