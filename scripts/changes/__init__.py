"""Points that come and go, held against fresh triangulations."""
