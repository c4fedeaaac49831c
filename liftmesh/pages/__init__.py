"""Pages that draw what they carry: one HTML file, with its data, its script and its controls."""
