"""What pages show of results: their layers."""
