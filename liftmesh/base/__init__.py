"""What every room builds on: clouds, arrays, options, immutable results."""
