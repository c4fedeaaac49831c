"""The shares of natural neighbours in hard places, against rationals."""
