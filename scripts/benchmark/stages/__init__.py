"""The stages of a run on any number of threads, counted by instructions on one."""
