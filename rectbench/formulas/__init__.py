"""The language of formulas on NumPy, Dr.Jit and jets; inverses of rising functions. Imports llvm, types."""
