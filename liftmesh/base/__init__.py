"""What every room builds on: clouds, arrays, options, results that stay as they are."""
