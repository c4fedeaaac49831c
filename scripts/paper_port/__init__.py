"""The paper's algorithms as printed, in plain C, and the ways a C program may have been written."""
