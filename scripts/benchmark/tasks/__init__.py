"""The benchmarks, each a module with `add_options` and `run`; `scripts/bench.py` lists them."""
