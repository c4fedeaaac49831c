"""Programs of the kernel's sources and a few of their own: how they are built, what they share."""
