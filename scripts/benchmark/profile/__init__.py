"""Instructions and mispredicted branches of the kernel: a small driver under callgrind."""
