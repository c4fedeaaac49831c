"""Tables of points: as text, read and written; what the columns of any table are."""
