"""The kernel's parallel code under ThreadSanitizer and AddressSanitizer."""
