"""How the paper's figures are drawn: a file for each thing they show, and their common tools."""
