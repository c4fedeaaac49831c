"""Structure-aware fuzzing of the file readers."""
