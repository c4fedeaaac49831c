"""Coverage-guided fuzzing of the kernel and of the file readers."""
