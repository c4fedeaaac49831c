"""The paper's figures: a module for each subject, and their common tools."""
