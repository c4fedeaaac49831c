"""Coverage-guided fuzzing of the kernel and of the readers, and sanitizer runs of the kernel."""
